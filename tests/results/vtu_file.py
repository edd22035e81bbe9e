"""A .vtu file of one piece, in every form that VTK writes."""

import base64
import lzma
import zlib

import lz4.block
import numpy as np

PACK = {
    "": None,
    "vtkZLibDataCompressor": zlib.compress,
    "vtkLZ4DataCompressor": lambda block: lz4.block.compress(block, store_size=False),
    "vtkLZMADataCompressor": lzma.compress,
}
#: a square and what belongs to it: names, types, numbers
SQUARE = {
    "Points": ("Float64", 3, [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]),
    "connectivity": ("Int64", 1, [0, 1, 2, 3]),
    "offsets": ("Int64", 1, [4]),
    "types": ("UInt8", 1, [9]),
    "u": ("Float64", 3, [[0, 0, 0], [1e-3, 0, 0], [1e-3, 0, 0], [0, 0, 0]]),
}
CODES = {"Float64": "f8", "Float32": "f4", "Int64": "i8", "Int32": "i4", "UInt8": "u1"}


def encoded(values, form, order, header, compressor, in_base64, block=16):
    """The bytes of an array as VTK writes them."""
    data = values.astype(values.dtype.newbyteorder(order)).tobytes()
    number = np.dtype({"UInt32": "u4", "UInt64": "u8"}[header]).newbyteorder(order)
    if not compressor:
        head, body = np.array([len(data)], number).tobytes(), data
        return base64.b64encode(head + body) if in_base64 else head + body
    blocks = [data[k : k + block] for k in range(0, len(data), block)]
    packed = [PACK[compressor](own) for own in blocks]
    last = len(data) % block
    head = np.array([len(blocks), block, last, *map(len, packed)], number).tobytes()
    body = b"".join(packed)
    return base64.b64encode(head) + base64.b64encode(body) if in_base64 else head + body


def file_of(
    arrays, form="ascii", order="<", header="UInt32", compressor="", in_base64=True, version="2.2", count=None
):
    """A .vtu file of one piece."""
    appended, texts = b"", {}
    for name, (kind, components, values) in arrays.items():
        values = np.asarray(values, dtype=CODES[kind])
        tag = f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="{form}"'
        if form == "ascii":
            texts[name] = f"{tag}>{' '.join(map(repr, values.ravel().tolist()))}</DataArray>"
            continue
        data = encoded(values, form, order, header, compressor, in_base64)
        if form == "binary":
            texts[name] = f"{tag}>\n  {data.decode()}\n</DataArray>"
        else:
            texts[name] = f'{tag} offset="{len(appended)}"/>'
            appended += data
    n, m = count or (len(arrays["Points"][2]), len(arrays["types"][2]))
    end = {"<": "LittleEndian", ">": "BigEndian"}[order]
    packed = f' compressor="{compressor}"' if compressor else ""
    cells = "".join(texts[name] for name in ("connectivity", "offsets", "types"))
    text = (
        f'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="{version}" byte_order="{end}" '
        f'header_type="{header}"{packed}><UnstructuredGrid><Piece NumberOfPoints="{n}" NumberOfCells="{m}">'
        f"<Points>{texts['Points']}</Points><Cells>{cells}</Cells><PointData>{texts.get('u', '')}</PointData>"
        "</Piece></UnstructuredGrid>"
    ).encode()
    if form == "appended":
        way = "base64" if in_base64 else "raw"
        text += f'<AppendedData encoding="{way}">_'.encode() + appended + b"</AppendedData>"
    return text + b"</VTKFile>"
