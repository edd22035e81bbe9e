"""Damaged files of every kind that is read: computed where they are still sound, else refused by name; nothing else.

Small sound files are damaged at random, by seeds that are the same every time; ``FUZZ_SEEDS=2000`` tries more of them.
"""

import contextlib
import os
import random
import re
import shutil
import signal
import zlib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from PIL import Image
from typer.testing import CliRunner

import slmm
from slmm.command.cli import app
from slmm.running.cell_file import LAYOUT, SCHEMA
from slmm.running.model_file import checksum

SEEDS = int(os.environ.get("FUZZ_SEEDS", "25"))
LONGEST = 30  # s, of one command; a sound file takes a tenth of a second
DATA = Path(__file__).parent / "data"
#: what stands on stderr beside the one sentence
BESIDE = re.compile(r"(compiling kernels, once.*|warning: .*)\n")

SCENE = """title = "Plate"
[plate]
width = 20.0
height = 20.0
[[holes]]
{hole}
[material]
E = 2960.0
nu = 0.35
sigma_c = 70.5
K_Ic = 1.96
[load]
strain = [0.0, 0.01, 0.0]
[analysis]
method = "rankine"
positions = 4
voxels = 4000
"""
HOLES = {
    "circle": 'shape = "circle"\ncenter = [10.0, 10.0]\nradius = 4.0',
    "csv": 'shape = "points"\nfile = "hole.csv"',
    "png": 'shape = "image"\nfile = "hole.png"\npixel_size = 0.5',
}


def scene(folder, hole):
    (folder / "scene.toml").write_text(SCENE.format(hole=HOLES[hole]))
    return ["initiation", "scene.toml"]


def toml(folder):
    return scene(folder, "circle"), "scene.toml"


def csv(folder):
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    rows = [f"{10 + 4 * np.cos(a):.6f},{10 + 4 * np.sin(a):.6f}" for a in angle]
    (folder / "hole.csv").write_text("\n".join(["x,y", *rows]) + "\n")
    return scene(folder, "csv"), "hole.csv"


def png(folder):
    y, x = np.mgrid[0:40, 0:40] + 0.5
    grey = np.clip(128 + 100 * (np.hypot(x - 20, y - 20) - 9), 0, 255)
    Image.fromarray(grey.astype(np.uint8)).save(folder / "hole.png")
    return scene(folder, "png"), "hole.png"


VTU_TEXT = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="9" NumberOfCells="4">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
{points}
</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">
0 1 4 3 1 2 5 4 3 4 7 6 4 5 8 7
</DataArray><DataArray type="Int64" Name="offsets" format="ascii">4 8 12 16</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">9 9 9 9</DataArray></Cells>
<PointData><DataArray type="Float64" Name="displacement" NumberOfComponents="3" format="ascii">
{u}
</DataArray></PointData>
</Piece></UnstructuredGrid></VTKFile>
"""


def vtu_text(folder):
    points = [(10.0 * i, 10.0 * j, 0.0) for j in range(3) for i in range(3)]
    lines = (
        "\n".join("{} {} {}".format(*p) for p in points),
        "\n".join(f"0 {0.01 * y} 0" for _, y, _ in points),
    )
    (folder / "model.vtu").write_text(VTU_TEXT.format(points=lines[0], u=lines[1]))
    return ["forces", "model.vtu", "--young", "3000", "--poisson", "0.3"], "model.vtu"


def vtu_binary(folder):
    shutil.copy(DATA / "plate.vtu", folder / "model.vtu")
    return ["forces", "model.vtu", "--young", "3000", "--poisson", "0.3"], "model.vtu"


def frd(folder):
    shutil.copy(DATA / "mixed_2d.frd", folder / "model.frd")
    shutil.copy(DATA / "mixed_2d.inp", folder / "model.inp")
    return ["forces", "model.frd"], "model.frd"


def inp(folder):
    return frd(folder)[0], "model.inp"


def displacements(folder):
    shutil.copy(DATA / "plate_2d.frd", folder / "model.frd")
    command = scene(folder, "circle")
    text = (folder / "scene.toml").read_text().replace("radius = 4.0", "radius = 2.0")
    (folder / "scene.toml").write_text(text)
    return [*command, "--displacements", "model.frd"], "model.frd"


def netcdf(folder):
    sizes = {name: 2 for name in {dim for dims in LAYOUT.values() for dim in dims}}
    numbers = np.random.default_rng(0)
    cells = xr.Dataset(
        {name: (dims, numbers.random([sizes[d] for d in dims])) for name, dims in LAYOUT.items()},
        coords={
            name: (name, np.arange(2.0), {"units": "1", "long_name": name})
            for name in ("curvature", "poisson", "crack_length", "eta")
        },
    )
    cells.attrs = {"schema": SCHEMA, "checksum": checksum(cells)}
    cells.to_netcdf(folder / "cells.nc", engine="netcdf4")
    return ["info", "cells.nc"], "cells.nc"


def sqlite(folder):
    command = [
        "optimize",
        "cantilever",
        "--grid",
        "5x3",
        "--algorithm",
        "fs",
        "--seed",
        "1",
        "-o",
        "found.nc",
    ]
    assert run(command).exit_code == 0
    return [*command, "--resume"], "found.journals/run-1.sqlite"


def npz(folder):
    from slmm.optimization import Cantilever
    from slmm.optimization.cantilever.brute_force import _State
    from slmm.optimization.cantilever.exhaustive import all_designs

    (folder / "found.journals").mkdir()
    state = _State(f"{Cantilever(5, 3)!r}, best 200000, {slmm.__version__}")
    state.add(next(iter(all_designs(Cantilever(5, 3)))), 200_000)
    state.write(folder / "found.journals" / "brute-force.npz")
    command = [
        "optimize",
        "cantilever",
        "--grid",
        "5x3",
        "--algorithm",
        "brute-force",
        "-o",
        "found.nc",
        "--resume",
    ]
    return command, "found.journals/brute-force.npz"


KINDS = (toml, csv, png, vtu_text, vtu_binary, frd, inp, displacements, netcdf, sqlite, npz)

NUMBER = re.compile(rb"-?\d+\.?\d*(?:[eE][-+]?\d+)?")
#: what stands in files that nobody expects, and what programs choke on
ODD = [
    *(
        b"0 -1 1e308 -1e308 1e-320 nan inf -inf 1e400 4294967296 9223372036854775808 0x7fffffff 1,5 1.5d0".split()
    ),
    *(
        b"\" ' [ ] { } = , ; : # * < > & \\ \x00 \xff \xef\xbb\xbf \r \n \t [/] :x: %s ../.. <a> </a> true".split(
            b" "
        )
    ),
    b"9" * 5000,
    b"[" * 3000,
    b"A" * 70000,
    b"",
]


def damaged(content, numbers):
    """The content with one to three damages."""
    for _ in range(numbers.choice([1, 1, 1, 2, 3])):
        size = len(content)
        at = numbers.randrange(size + 1)
        length = min(numbers.choice([1, 1, 2, 8, 64, 512]), size)
        match numbers.randrange(7):
            case 0:
                content = bytearray(content)
                for _ in range(numbers.choice([1, 2, 8])):
                    if content:
                        content[numbers.randrange(len(content))] ^= 1 << numbers.randrange(8)
                content = bytes(content)
            case 1:
                content = content[:at]
            case 2:
                content = content[:at] + content[at + length :]
            case 3:
                content = content[:at] + numbers.choice(ODD) + content[at:]
            case 4:
                start = numbers.randrange(size - length + 1)
                content = content[:at] + content[start : start + length] + content[at:]
            case 5:
                content = content[:at] + numbers.randbytes(length) + content[at + length :]
            case 6:
                found = list(NUMBER.finditer(content))
                if found:
                    one = numbers.choice(found)
                    other = numbers.choice([*ODD, numbers.choice(found)[0]])
                    content = content[: one.start()] + other + content[one.end() :]
    return content


def run(command):
    return CliRunner().invoke(app, command)


class TooLongError(BaseException):
    """No error that a command could catch."""


@contextlib.contextmanager
def limited(seconds):
    """End what takes longer, where the system can."""
    if not hasattr(signal, "SIGALRM"):
        yield
        return

    def stop(*_):
        raise TooLongError(f"takes longer than {seconds} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def wrong(result, name, undisturbed):
    """What is wrong with the end of a command whose file is damaged; empty when nothing is.

    What a journal remembers does not change what is found: that must be what it was, if anything.
    """
    if not isinstance(result.exception, SystemExit | None):
        return f"raised {result.exception!r}"
    says = BESIDE.sub("", result.stderr)
    if result.exit_code == 0:
        if "journals" in name and result.stdout != undisturbed:
            return f"found something else: {result.stdout[:300]!r}"
        return "" if says == "" else f"code 0, but {says[:300]!r}"
    if not says.startswith("error: ") or len(re.findall(r"^\S", says, re.MULTILINE)) != 1:
        return f"code {result.exit_code}, no single sentence: {says[:500]!r}"
    if len(says) > 3000:
        return f"{len(says)} characters: {says[:200]!r}"
    if result.exit_code == 1 and name == "scene.toml":
        return ""  # a scene that is still one, and has no value anywhere
    if result.exit_code != 2:
        return f"code {result.exit_code}: {says[:300]!r}"
    if Path(name).name not in says:
        return f"does not name {name}: {says[:300]!r}"
    if result.stdout:
        return f"wrote {result.stdout[:200]!r}"
    return ""


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_a_damaged_file_is_computed_or_refused_by_name(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    command, name = kind(tmp_path)
    sound = (tmp_path / name).read_bytes()
    first = run(command)
    assert first.exit_code == 0, first.stderr
    files = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    failures = []
    for seed in range(SEEDS):
        content = damaged(sound, random.Random(zlib.crc32(f"{kind.__name__} {seed}".encode())))
        for path in set(tmp_path.rglob("*")) - set(files):
            if path.is_file():
                path.unlink()
        for path, before in files.items():
            path.write_bytes(before)
        (tmp_path / name).write_bytes(content)
        try:
            with limited(LONGEST):
                problem = wrong(run(command), name, first.stdout)
        except TooLongError as error:
            problem = str(error)
        if problem:
            failures.append(f"seed {seed}: {problem}")
    assert not failures, f"{len(failures)} of {SEEDS}:\n" + "\n".join(failures[:40])
