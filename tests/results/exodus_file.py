"""Exodus files of any mesh, written for the tests."""

import netCDF4
import numpy as np


def write(path, called, points, steps, blocks=None, names=("disp_x", "disp_y", "disp_z")):
    """An Exodus file with a block for each of the elements, and displacements (n, d) at each step."""
    n, d = points.shape
    blocks = [np.arange(1, n + 1)[None]] if blocks is None else blocks
    with netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:
        file.createDimension("len_string", 33)
        file.createDimension("time_step", None)
        for name, size in (("num_nodes", n), ("num_dim", d), ("num_nod_var", d), ("num_el_blk", len(blocks))):
            file.createDimension(name, size)
        for axis in range(d):
            file.createVariable(f"coord{'xyz'[axis]}", "f8", ("num_nodes",))[:] = points[:, axis]
        for k, block in enumerate(blocks, start=1):
            file.createDimension(f"num_el_in_blk{k}", len(block))
            file.createDimension(f"num_nod_per_el{k}", len(block[0]))
            nodes = file.createVariable(f"connect{k}", "i4", (f"num_el_in_blk{k}", f"num_nod_per_el{k}"))
            nodes.elem_type, nodes[:] = called, block
        file.createVariable("time_whole", "f8", ("time_step",))[:] = np.arange(len(steps))
        letters = file.createVariable("name_nod_var", "S1", ("num_nod_var", "len_string"))
        for axis in range(d):
            letters[axis] = netCDF4.stringtochar(np.array([names[axis]], dtype="S33"))[0]
            values = file.createVariable(f"vals_nod_var{axis + 1}", "f8", ("time_step", "num_nodes"))
            for k, u in enumerate(steps):
                values[k] = u[:, axis]
    return path
