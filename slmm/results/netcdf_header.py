"""The header of a netCDF file in the classic formats, walked before the library opens it.

At a damaged count the library takes gigabytes and minutes before it gives up. The form is that of "NetCDF Classic
Format Specification" (https://docs.unidata.ucar.edu/nug/current/file_format_specifications.html).
"""

from __future__ import annotations

from pathlib import Path

#: bytes of a value by the number of its type
SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 4, 6: 8, 7: 1, 8: 2, 9: 4, 10: 8, 11: 8}
#: how lists of dimensions, variables and attributes begin
DIMENSIONS, VARIABLES, ATTRIBUTES = 10, 11, 12


class _Header:
    """The bytes of a file from a place on."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 4
        self.wide = 8 if data[3] == 5 else 4  # of counts
        self.offset = 4 if data[3] == 1 else 8  # of the places of variables

    def number(self, size: int) -> int:
        found = int.from_bytes(self.data[self.at : self.at + size], "big")
        self.skip(size)
        return found

    def skip(self, size: int) -> None:
        self.at += size
        if self.at > len(self.data):
            raise ValueError("its header is cut off or damaged")

    def padded(self, size: int) -> None:
        self.skip(-(-size // 4) * 4)

    def count(self, kind: int) -> int:
        """Of the elements of a list."""
        tag, count = self.number(4), self.number(self.wide)
        if (tag, count) != (0, 0) and tag != kind:
            raise ValueError("its header is damaged")
        return count

    def name(self) -> None:
        self.padded(self.number(self.wide))

    def attributes(self) -> None:
        for _ in range(self.count(ATTRIBUTES)):
            self.name()
            kind = self.number(4)
            if kind not in SIZES:
                raise ValueError(f"its header has values of type {kind}")
            self.padded(SIZES[kind] * self.number(self.wide))


def check_netcdf(path: Path) -> None:
    """Refuse a file that is no netCDF, or whose header leads beyond its end.

    Raises
    ------
    ValueError
        Without the file's name. Files in HDF5 are left to its library.
    """
    data = path.read_bytes()
    if data.startswith(b"\x89HDF\r\n"):
        return
    if data[:3] != b"CDF" or data[3:4] not in (b"\1", b"\2", b"\5"):
        raise ValueError("it is no netCDF file")
    header = _Header(data)
    header.skip(header.wide)
    for _ in range(header.count(DIMENSIONS)):
        header.name()
        header.skip(header.wide)
    header.attributes()
    for _ in range(header.count(VARIABLES)):
        header.name()
        header.skip(header.wide * header.number(header.wide))
        header.attributes()
        header.skip(4 + header.wide + header.offset)
