"""The corridor plan: each room imports only rooms above it, and no file imports itself on a way round."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
#: from above; files are read and threads are kept for all the others
ROOMS = (
    "running",
    "mechanics",
    "part",
    "scene",
    "criteria",
    "voxels",
    "fem",
    "boundary",
    "results",
    "initiation",
    "fracture",
    "optimization",
    "pictures",
    "command",
)
FILES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
    for path in sorted((ROOT / "slmm").rglob("*.py"))
}


def imported(path):
    """Modules of the package that a file imports, at its head or later; not those for types alone."""
    tree = ast.parse(path.read_text())
    for_types = {
        id(node)
        for block in ast.walk(tree)
        if isinstance(block, ast.If) and ast.unparse(block.test) == "TYPE_CHECKING"
        for node in ast.walk(block)
    }
    found = set()
    for node in ast.walk(tree):
        if id(node) in for_types:
            continue
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            modules = {f"{node.module}.{alias.name}" for alias in node.names} & FILES.keys()
            found |= modules or {node.module}
    return found & FILES.keys()


GRAPH = {name: imported(path) for name, path in FILES.items()}


def room(module):
    parts = module.split(".")
    return parts[1] if len(parts) > 1 and parts[1] in ROOMS else None


def test_every_folder_is_a_room():
    folders = {path.name for path in (ROOT / "slmm").iterdir() if any(path.glob("*.py"))}
    assert folders == set(ROOMS)


@pytest.mark.parametrize("name", ROOMS)
def test_a_room_imports_only_rooms_above_it(name):
    below = ROOMS[ROOMS.index(name) + 1 :]
    wrong = [
        f"{module} imports {other}"
        for module, others in GRAPH.items()
        if room(module) == name
        for other in others
        if room(other) in below
    ]
    assert not wrong


def test_no_file_imports_itself_on_a_way_round():
    try:
        TopologicalSorter(GRAPH).prepare()
    except CycleError as error:
        pytest.fail(" imports ".join(reversed(error.args[1])))
