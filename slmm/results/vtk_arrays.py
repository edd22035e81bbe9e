"""Arrays of VTK's XML files: as text, or as base64 or bytes behind a header, compressed in blocks or not.

Sizes are compared with what the file must hold before anything is decoded or decompressed. The form is that of "VTK
XML Formats" (https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html).
"""

from __future__ import annotations

import base64
import binascii
import lzma
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal
from xml.etree.ElementTree import Element

import lz4.block
import numpy as np

#: types of numbers by VTK's names
NUMBERS = {
    f"{name}{bits}": np.dtype(f"{code}{bits // 8}")
    for name, code, sizes in (
        ("Int", "i", (8, 16, 32, 64)),
        ("UInt", "u", (8, 16, 32, 64)),
        ("Float", "f", (32, 64)),
    )
    for bits in sizes
}

#: bytes that the arrays of one file may take in memory, chosen: 40 million nodes and their displacements in space
LARGEST = 4 * 2**30


#: bytes of memory that LZMA's own dictionary may take, chosen: its strongest setting takes 65 MB
DICTIONARY = 2**28


def _zlib(block: bytes, size: int) -> bytes:
    # a byte more than there should be shows that there are more
    stream = zlib.decompressobj()
    found = stream.decompress(block, size + 1)
    return found if stream.eof else b""


def _lzma(block: bytes, size: int) -> bytes:
    stream = lzma.LZMADecompressor(memlimit=DICTIONARY)
    found = stream.decompress(block, size + 1)
    return found if stream.eof else b""


def _lz4(block: bytes, size: int) -> bytes:
    return lz4.block.decompress(block, uncompressed_size=size)


#: a block that should have so many bytes: when it has more or is cut off, what comes back has another number
DECOMPRESS: dict[str, Callable[[bytes, int], bytes]] = {
    "vtkZLibDataCompressor": _zlib,
    "vtkLZMADataCompressor": _lzma,
    "vtkLZ4DataCompressor": _lz4,
}


@dataclass
class Encoding:
    """How the arrays of a file are written.

    Parameters
    ----------
    byte_order : {"<", ">"}
    header : dtype
        Of the numbers in front of binary data.
    compressor : str
        One of `DECOMPRESS`, or empty.
    appended : bytes
        The data behind the elements, after their underscore.
    in_base64 : bool
        Whether they are.
    left : int
        Bytes of memory that the file may still take.
    """

    byte_order: Literal["<", ">"]
    header: np.dtype
    compressor: str
    appended: bytes = b""
    in_base64: bool = True
    left: int = field(default=LARGEST)

    @classmethod
    def of(cls, root: Element, appended: bytes, in_base64: bool) -> Encoding:
        """That which the file's first element tells."""
        orders: dict[str, Literal["<", ">"]] = {"LittleEndian": "<", "BigEndian": ">"}
        order, header = root.get("byte_order", "LittleEndian"), root.get("header_type", "UInt32")
        compressor = root.get("compressor", "")
        for name, value, known in (
            ("byte_order", order, list(orders)),
            ("header_type", header, ["UInt32", "UInt64"]),
            ("compressor", compressor, ["", *DECOMPRESS]),
        ):
            if value not in known:
                raise ValueError(f"{name} = {value!r}: must be one of {', '.join(filter(None, known))}")
        return cls(
            orders[order], NUMBERS[header].newbyteorder(orders[order]), compressor, appended, in_base64
        )


def read_array(array: Element, encoding: Encoding, rows: int) -> np.ndarray:
    """The numbers (rows,) or (rows, components) of a DataArray.

    Raises
    ------
    ValueError
        When there are more or fewer, or they are damaged; the array is named.
    """
    name = array.get("Name") or "without name"
    try:
        components = int(array.get("NumberOfComponents") or 1)
        if components < 1:
            raise ValueError(f"NumberOfComponents = {components}: must be at least 1")
        values = _numbers(array, encoding, rows * components)
    except ValueError as error:
        raise ValueError(f"the array {name}: {error}") from error
    return values.reshape(rows, components) if components > 1 else values


def _numbers(array: Element, encoding: Encoding, count: int) -> np.ndarray:
    kind, form = array.get("type", ""), array.get("format", "ascii")
    if kind not in NUMBERS:
        raise ValueError(f"type = {kind!r}: must be one of {', '.join(NUMBERS)}")
    number = NUMBERS[kind]
    encoding.left -= count * max(number.itemsize, 8)
    if encoding.left < 0:
        raise ValueError(f"{count} numbers: the arrays of the file take more than {LARGEST >> 30} GB")
    text = array.text or ""
    if form == "ascii":
        words = text.split()
        if len(words) != count:
            raise ValueError(f"has {len(words)} numbers: {count} are expected")
        try:
            return np.array(words, dtype=number) if words else np.zeros(0, number)
        except (ValueError, OverflowError) as error:
            raise ValueError(f"has a word that is no number of type {kind}") from error
    if count == 0:
        return np.zeros(0, number)  # some programs write no header then
    number = number.newbyteorder(encoding.byte_order)
    size = count * number.itemsize
    if form == "binary":
        data = _payload(_Base64("".join(text.split()).encode("ascii", "replace")), encoding, size)
    elif form == "appended":
        offset = int(array.get("offset", ""))
        if not 0 <= offset < len(encoding.appended):
            raise ValueError(f"offset = {offset}: there are {len(encoding.appended)} bytes of appended data")
        source = _Base64(encoding.appended, offset) if encoding.in_base64 else _Raw(encoding.appended, offset)
        data = _payload(source, encoding, size)
    else:
        raise ValueError(f"format = {form!r}: must be ascii, binary or appended")
    return np.frombuffer(data, number).astype(number.newbyteorder("="))


class _Raw:
    """Bytes as they are, from a place on."""

    def __init__(self, data: bytes, at: int) -> None:
        self.data, self.at = data, at

    def head(self, size: int) -> bytes:
        """The next bytes, which stay."""
        return _whole(self.data[self.at : self.at + size], size)

    def take(self, size: int) -> bytes:
        """The next bytes, which end then."""
        found = self.head(size)
        self.at += size
        return found

    def rest(self, size: int) -> bytes:
        """The bytes after those taken, which may belong to them."""
        return self.take(size)


class _Base64:
    """Bytes in base64, which may end and begin anew between header and data."""

    def __init__(self, text: bytes, at: int = 0) -> None:
        self.text, self.at, self.over = text, at, b""

    def head(self, size: int) -> bytes:
        return self._decoded(self.at, size)[:size]

    def take(self, size: int) -> bytes:
        found = self._decoded(self.at, size)
        self.at += -(-size // 3) * 4
        self.over = found[size:]
        return found[:size]

    def rest(self, size: int) -> bytes:
        return (self.over + self._decoded(self.at, size - len(self.over)))[:size]

    def _decoded(self, at: int, size: int) -> bytes:
        text = self.text[at : at + max(-(-size // 3) * 4, 0)]
        try:
            found = base64.b64decode(text, validate=True)
        except binascii.Error as error:
            raise ValueError(f"is no base64: {error}") from error
        return _whole(found, size)


def _whole(data: bytes, size: int) -> bytes:
    if len(data) < size:
        raise ValueError(f"is cut off: {size} bytes are expected, {len(data)} are there")
    return data


def _payload(source: _Raw | _Base64, encoding: Encoding, size: int) -> bytes:
    """The bytes of an array, which must be so many."""
    width = encoding.header.itemsize
    if not encoding.compressor:
        (told,) = _header(source.take(width), encoding)
        if told != size:
            raise ValueError(f"has {told} bytes: {size} are expected")
        return source.rest(size)
    (blocks,) = _header(source.head(width), encoding)
    # a block holds a byte at least
    if not 0 < blocks <= size:
        raise ValueError(f"has {blocks} compressed blocks: must be 1 to {size}")
    _, full, last, *packed = _header(source.take((3 + blocks) * width), encoding)
    sizes = [full] * (blocks - 1) + [last or full]
    if sum(sizes) != size or min(sizes) < 1:
        raise ValueError(f"has {sum(sizes)} bytes after decompression: {size} are expected")
    data, found, at = source.rest(sum(packed)), [], 0
    for block, unpacked in zip(packed, sizes, strict=True):
        try:
            plain = DECOMPRESS[encoding.compressor](data[at : at + block], unpacked)
        except (zlib.error, lzma.LZMAError, lz4.block.LZ4BlockError) as error:
            raise ValueError(f"cannot be decompressed: {error}") from error
        if len(plain) != unpacked:
            raise ValueError(f"a compressed block has not the {unpacked} bytes that its header tells")
        found.append(plain)
        at += block
    return b"".join(found)


def _header(data: bytes, encoding: Encoding) -> list[int]:
    return np.frombuffer(data, encoding.header).tolist()
