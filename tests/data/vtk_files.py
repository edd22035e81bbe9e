"""Write the files in vtk/ with VTK 9.7 (pip install vtk): python vtk_files.py

plane_cells.vtu and solid_cells.vtu hold one cell of each type that is read, affine, under the displacements of `field`;
the others hold one small mesh in several encodings, or as pieces.
"""

from pathlib import Path

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

FOLDER = Path(__file__).parent / "vtk"
PLANE, SOLID = (5, 8, 9, 22, 23, 28, (69, 1), (69, 2), (70, 1), (70, 2)), (
    10, 11, 12, 13, 24, 25, 26, 29, 32, (71, 1), (71, 2), (72, 1), (72, 2), (73, 1), (73, 2),
)  # fmt: skip
NODES = {(69, 1): 3, (69, 2): 6, (70, 1): 4, (70, 2): 9, (71, 1): 4, (71, 2): 10, (72, 1): 8, (72, 2): 27, (73, 1): 6,
         (73, 2): 18}  # fmt: skip


def reference(cell_type):
    """The nodes (n, 3) of a cell in its own coordinates, as VTK says."""
    kind, order = cell_type if isinstance(cell_type, tuple) else (cell_type, None)
    cell = vtk.vtkGenericCell.InstantiateCell(kind)
    if order:
        n = NODES[cell_type]
        cell.GetPointIds().SetNumberOfIds(n)
        cell.GetPoints().SetNumberOfPoints(n)
        if kind == 70:
            cell.SetOrder(order, order)
        elif kind == 72:
            cell.SetOrder(order, order, order)
        elif kind == 73:
            cell.SetOrder(order, order, order, n)
        cell.Initialize()
    return kind, np.array(cell.GetParametricCoords()[: 3 * cell.GetNumberOfPoints()]).reshape(-1, 3)


def field(x, second):
    """Linear displacements, or quadratic ones for cells of the second order."""
    linear = 1e-3 * x @ np.array([[1.0, 0.2, 0.3], [-0.4, 0.5, 0.1], [0.2, -0.3, 0.7]])
    return linear + second * 1e-4 * np.stack([x[:, 0] * x[:, 1], x[:, 1] ** 2, x[:, 2] * x[:, 0]], axis=1)


def grid(points, cells, u):
    result, at = vtk.vtkUnstructuredGrid(), vtk.vtkPoints()
    at.SetData(numpy_to_vtk(points, deep=True))
    result.SetPoints(at)
    for kind, nodes in cells:
        result.InsertNextCell(kind, len(nodes), [int(node) for node in nodes])
    for name, values, data in (
        ("u", u, result.GetPointData()),
        ("T", np.arange(len(points)), result.GetPointData()),
        ("region", np.arange(len(cells)) % 2, result.GetCellData()),
    ):
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        data.AddArray(array)
    return result


def cells_of_all_types(types, flat):
    points, cells, u = [], [], []
    for k, cell_type in enumerate(types):
        kind, nodes = reference(cell_type)
        shape = np.array([[2.0, 0.3, 0.1], [-0.2, 1.5, 0.2], [0.1, -0.1, 1.2]])
        if flat:
            shape[2] = shape[:, 2] = 0
        if kind in (8, 11):
            shape = np.diag(np.diag(shape))
        x = nodes @ shape.T + [4.0 * k, 0, 0]
        cells.append((kind, range(sum(map(len, points)), sum(map(len, points)) + len(x))))
        points.append(x)
        second = len(x) > 8 or (flat and len(x) in (6, 8))
        u.append(field(x, second) * [1, 1, not flat])
    return grid(np.concatenate(points), cells, np.concatenate(u))


def strip(nx=3, ny=2):
    x, y = np.meshgrid(np.arange(nx + 1.0), np.arange(ny + 1.0))
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    number = np.arange(len(points)).reshape(ny + 1, nx + 1)
    corners = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1)
    return grid(points, [(9, own) for own in corners.reshape(-1, 4)], field(points, False) * [1, 1, 0])


def write(name, data, mode="Appended", compressor=None, big=False, wide=True, raw=False):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(data)
    getattr(writer, f"SetDataModeTo{mode}")()
    writer.SetCompressor(compressor) if compressor else writer.SetCompressorTypeToNone()
    writer.SetByteOrderToBigEndian() if big else writer.SetByteOrderToLittleEndian()
    writer.SetHeaderTypeToUInt64() if wide else writer.SetHeaderTypeToUInt32()
    writer.SetEncodeAppendedData(not raw)
    writer.SetFileName(str(FOLDER / name))
    writer.Write()


def pieces(data, ghosts):
    split = vtk.vtkExtractUnstructuredGridPiece()
    split.SetInputData(data)
    for k in range(2):
        split.UpdatePiece(k, 2, ghosts)
        write(f"pieces_{k}.vtu", split.GetOutput(), compressor=vtk.vtkZLibDataCompressor())


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    write("plane_cells.vtu", cells_of_all_types(PLANE, True), compressor=vtk.vtkZLibDataCompressor())
    write("solid_cells.vtu", cells_of_all_types(SOLID, False), compressor=vtk.vtkZLibDataCompressor())
    write("ascii.vtu", strip(), "Ascii")
    write("binary_zlib.vtu", strip(), "Binary", vtk.vtkZLibDataCompressor(), wide=False)
    write("binary_big_endian.vtu", strip(), "Binary", big=True)
    write("appended_lz4.vtu", strip(), compressor=vtk.vtkLZ4DataCompressor())
    write("appended_raw_lzma.vtu", strip(), compressor=vtk.vtkLZMADataCompressor(), raw=True, wide=False)
    write("appended_raw_big_endian.vtu", strip(), big=True, raw=True)
    pieces(strip(), 1)
    for name, binary in (("ascii.vtk", False), ("binary.vtk", True)):
        writer = vtk.vtkUnstructuredGridWriter()
        writer.SetInputData(strip())
        writer.SetFileType(1 + binary)
        writer.SetFileName(str(FOLDER / name))
        writer.Write()
    (FOLDER / "pieces.pvtu").write_text(
        '<VTKFile type="PUnstructuredGrid" version="2.2"><PUnstructuredGrid GhostLevel="1">'
        '<Piece Source="pieces_0.vtu"/><Piece Source="pieces_1.vtu"/></PUnstructuredGrid></VTKFile>\n'
    )
