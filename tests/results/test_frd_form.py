"""The forms of .frd files hold the same; what is cut off or damaged is refused with the line."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.results.frd import NUMBERED, read_frd
from slmm.results.results import read_displacements

DATA = Path(__file__).parents[1] / "data"


def short_form(text: str) -> str:
    """A file in the form with five columns for numbers of nodes and elements."""
    short, block = [], ""
    for line in text.splitlines():
        if line[:6].strip() in ("2C", "3C", "100C"):
            block = line[:6].strip()
            short.append(line.rstrip()[:-1] + "0")
        elif line.startswith(" -1"):
            short.append(line[:3] + line[8:])
        elif line.startswith(" -2") and block == "3C":
            numbers = [line[i : i + 10] for i in range(3, len(line), 10)]
            short.append(" -2" + "".join(number[5:] for number in numbers))
        else:
            short.append(line)
    return "\n".join(short) + "\n"


def joined_node_lines(text: str) -> str:
    """Fifteen numbers of nodes in a line in place of ten."""
    lines: list[str] = []
    for line in text.splitlines():
        if line.startswith(" -2") and lines[-1].startswith(" -2"):
            numbers = lines.pop()[3:] + line[3:]
            lines += [" -2" + numbers[i : i + 75] for i in range(0, len(numbers), 75)]
        else:
            lines.append(line)
    return "\n".join(lines) + "\n"


def test_short_and_long_form_are_the_same(tmp_path):
    long = read_frd(DATA / "mixed_expanded.frd")
    (tmp_path / "short.frd").write_text(
        joined_node_lines(short_form((DATA / "mixed_expanded.frd").read_text()))
    )
    short = read_frd(tmp_path / "short.frd")
    assert np.array_equal(short.nodes, long.nodes) and np.array_equal(short.node_ids, long.node_ids)
    assert short.cells.keys() == long.cells.keys()
    for kind in long.cells:
        assert np.array_equal(short.cells[kind], long.cells[kind])
        assert np.array_equal(short.cell_ids[kind], long.cell_ids[kind])
    assert np.array_equal(short.fields["DISP"][0].values, long.fields["DISP"][0].values)


def test_results_with_more_than_six_components_go_on_in_the_next_line(tmp_path):
    text = (DATA / "mixed_2d.frd").read_text()
    begin, end = text.index(" -4  DISP"), text.index(" 9999")
    names = "".join(f" -5  {'V' + str(k):8s}    1    1    0    0\n" for k in range(8))
    lines = [
        f" -1{3:10d}" + "".join(f"{-k - 0.5:12.5E}" for k in range(6)),
        " -2          " + "".join(f"{-k - 0.5:12.5E}" for k in (6, 7)),
    ]
    header = text[:begin].replace("          25                     0", "           1                     0")
    (tmp_path / "eight.frd").write_text(
        header + " -4  MANY        8    1\n" + names + "\n".join(lines) + "\n -3\n" + text[end:]
    )
    (field,) = (result := read_frd(tmp_path / "eight.frd")).fields["MANY"]
    assert field.components == tuple(f"V{k}" for k in range(8))
    assert field.values[result.node_ids == 3][0] == pytest.approx(-np.arange(8) - 0.5)
    assert np.isnan(field.values[result.node_ids != 3]).all()


def test_midside_nodes_of_expanded_elements_lie_between_their_corners():
    result = read_frd(DATA / "mixed_expanded.frd")
    pairs = {
        "hexahedron20": [
            (0, 1),
            (1, 2),
            (2, 3),
            (3, 0),
            (4, 5),
            (5, 6),
            (6, 7),
            (7, 4),
            (0, 4),
            (1, 5),
            (2, 6),
            (3, 7),
        ],
        "wedge15": [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
    }
    for kind, ends in pairs.items():
        at = result.nodes[result.cells[kind]]
        corners = at.shape[1] - len(ends)
        middle = at[:, ends].mean(axis=2)
        # one edge of the model has its node 0.03 mm beside the middle
        assert at[:, corners:] == pytest.approx(middle, abs=0.0601)
    assert {kind for kind, _, _ in NUMBERED.values()} >= set(result.cells)


@given(share=st.floats(0, 1, exclude_max=True))
def test_a_file_that_is_cut_off_anywhere_is_refused(share, tmp_path_factory):
    whole = (DATA / "mixed_2d.frd").read_bytes().rstrip()
    path = tmp_path_factory.getbasetemp() / "cut.frd"
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(ValueError, match=r"cut\.frd"):
        read_displacements(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("    1C", "    ??", "no CalculiX result file"),
        ("                          25                                     1", None, r"\*NODE FILE"),
        (" -2         1         3         9", " -2         1         3       999", "names node 999"),
        (" -1         5    7    0    1", " -1         5   17    0    1", "element type 17"),
        (" -1         3 1.00000E+00", " -1         3 1.0000", r"line 15: 31 columns, not 36"),
        (
            " -1         3 1.00000E+00",
            " -1         3 one.0000+00",
            r"line 15: ' one.0000\+00' in place of a number",
        ),
        (
            "  100CL  101 1.000000000          25",
            "  100CL  101 1.000000000          26",
            "26 nodes announced, 25",
        ),
        (" -4  DISP  ", " -4  FORC  ", r"holds no displacements \(DISP\), only FORC"),
        (" -1         8 3.06000E-03 1.33200E-03-5.42101E-20", None, "no finite displacement of node 8 "),
        (
            " -1         8 3.06000E-03",
            " -1         8         NaN",
            "no finite displacement of node 8 ",
        ),
        (" 9999", "", "9999, is missing"),
    ],
)
def test_a_damaged_frd_file_is_refused_with_the_reason(old, new, message, tmp_path):
    text = (DATA / "mixed_2d.frd").read_text()
    assert text.count(old) >= 1
    if new is None and old.startswith(" -1"):
        text = text.replace(old + "\n", "").replace("1.000000000          25", "1.000000000          24")
    else:
        # binary results have the form 2 or 3
        text = text.replace(old, old[:-1] + "2" if new is None else new, 1)
    (tmp_path / "damaged.frd").write_text(text)
    with pytest.raises(ValueError, match=message):
        read_displacements(tmp_path / "damaged.frd")
