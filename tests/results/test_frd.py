"""Result files of CalculiX are read as it writes them, also where it keeps no columns; what is damaged is refused."""

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slmm.results.frd import read_frd
from slmm.results.read_results import read_element_results
from slmm.results.results import read_displacements

DATA = Path(__file__).parents[1] / "data"
CASES = Path(__file__).parents[3] / "shared" / "cases"
MIXED, BAR = DATA / "mixed_2d.frd", DATA / "bar_3d.frd"


@pytest.fixture
def changed(tmp_path):
    """A copy of the result of mixed elements, without its input file, with something else in it."""

    def write(*changes, text=None):
        text = MIXED.read_text() if text is None else text
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "changed.frd").write_text(text)
        return tmp_path / "changed.frd"

    return write


def test_components_with_tabs_between_their_numbers_are_read():
    result = read_frd(CASES / "09-frd-norm-block" / "norm.frd")
    (norm,) = result.fields["NORM"]
    assert norm.components == ("NORMX", "NORMY", "NORMZ")
    assert norm.values.tolist() == [[0, 0, 1]] * 8


def test_a_result_of_calculix_with_its_normals_has_the_stresses_it_has_without():
    results = read_element_results(CASES / "09-frd-norm-block" / "norm.frd")
    assert results.stress["C3D8"][0, 0, 0, 0] == pytest.approx(263.4, abs=0.05)


def test_an_exponent_of_fortran_in_the_input_file_is_the_same_material():
    results = read_element_results(CASES / "10-inp-d-exponent" / "d.frd")
    assert results.elasticity[0].E == 210e3


def test_a_set_of_elements_that_are_not_there_is_refused_at_once():
    with pytest.raises(
        ValueError, match=r"m\.inp, line 105: '1, 100000000000': names elements that the file does not"
    ):
        read_element_results(CASES / "r08-inp-generate" / "m.frd")


def test_what_is_wrong_with_results_that_nobody_asks_for_is_no_hindrance(changed):
    # a block that CalculiX announces and leaves empty, as of flows
    empty = (
        "  100CL  101 1.000000000          25                     0    1           1\n"
        " -4  VELO        4    1\n -5  V1          1    2    1    0\n -3\n"
    )
    path = changed((" 9999", empty + " 9999"))
    assert np.array_equal(read_displacements(path).u, read_displacements(MIXED).u)
    with pytest.raises(ValueError, match=r"changed\.frd, line \d+: 25 nodes announced, 0 found"):
        _ = read_frd(path).fields["VELO"][0].values


def test_composite_elements_are_announced_as_one_and_have_an_element_for_each_layer(changed):
    (announced,) = re.findall(r"    3C +\d+ ", MIXED.read_text())
    assert len(read_frd(changed((announced, announced.replace("6", "3")))).cells["quad8"])
    with pytest.raises(ValueError, match="7 elements announced, 6 found"):
        read_frd(changed((announced, announced.replace("6", "7"))))


@pytest.mark.parametrize("count", [1, 3, 20])
def test_nodes_of_an_element_may_stand_in_lines_of_any_length(count, tmp_path):
    text, lines = (DATA / "mixed_expanded.frd").read_text(), []
    for line in text.splitlines():
        if line.startswith(" -2"):
            numbers = re.findall(".{10}", line[3:])
            if lines[-1].startswith(" -2"):
                numbers = re.findall(".{10}", lines.pop()[3:]) + numbers
            lines += [" -2" + "".join(numbers[k : k + count]) for k in range(0, len(numbers), count)]
        else:
            lines.append(line)
    if count == 20:
        lines = "\n".join(lines).split("\n")
    (tmp_path / "lines.frd").write_text("\n".join(lines) + "\n")
    expected, found = read_frd(DATA / "mixed_expanded.frd"), read_frd(tmp_path / "lines.frd")
    assert all(np.array_equal(found.cells[kind], nodes) for kind, nodes in expected.cells.items())


def with_long_exponents(text):
    """As programs on Windows write numbers: those below zero have a column more."""
    return re.sub(r" ?(-?\d\.\d{5}E[+-])(\d\d)", lambda m: m[1] + "0" + m[2], text)


def test_exponents_of_three_digits_are_read(changed):
    path = changed(text=with_long_exponents(BAR.read_text()))
    assert max(map(len, path.read_text().splitlines())) > 85
    expected, found = read_frd(BAR), read_frd(path)
    assert np.array_equal(found.nodes, expected.nodes)
    for name in ("DISP", "STRESS", "ENER"):
        assert np.array_equal(found.fields[name][-1].values, expected.fields[name][-1].values)


def test_a_number_that_is_cut_off_is_not_taken_for_another_one(changed):
    text = MIXED.read_text()
    line = text[text.index(" -4  DISP") :].split("\n")[6]
    for cut in range(1, 24):
        path = changed((line, line[:-cut]))
        with pytest.raises(ValueError, match=r"line \d+: \d+ columns, not 36, for 3 numbers"):
            read_displacements(path)
        long = with_long_exponents(text)
        path = changed((with_long_exponents(line), with_long_exponents(line)[:-cut]), text=long)
        # what is left may be as wide as three numbers with short exponents
        with pytest.raises(
            ValueError, match=r"line \d+: (\d+ columns, not 36, for 3|.* in place of a) number"
        ):
            read_displacements(path)


@pytest.mark.parametrize(
    "value", ["         NaN", "         NAN", "    Infinity", "        -INF", "************"]
)
def test_displacements_that_are_no_numbers_are_refused_and_such_stresses_only_where_they_are_wanted(
    value, changed
):
    text = BAR.read_text()
    displacement, stress = (text[text.index(f" -4  {name}") :].split("\n")[9] for name in ("DISP", "STRESS"))
    broken = changed((displacement, displacement[:13] + value * 3), text=text)
    with pytest.raises(
        ValueError, match=r"changed\.frd: no finite displacement of node \d+ \(1 of \d+ such nodes\)"
    ):
        read_element_results(broken)
    path = changed((stress, stress[:13] + value * 6), text=text)
    with pytest.raises(ValueError, match="STRESS is not known, or not finite"):
        read_element_results(path)
    path.with_suffix(".inp").write_text(BAR.with_suffix(".inp").read_text())
    assert read_element_results(path).source.startswith("displacements")


@pytest.mark.parametrize(
    ("kind", "value", "refused"), [("0", "1.000000000", False), ("1", "1.000000000", False), ("2", "63.50000000", True),
                                   ("4", "48.15455528", True), ("4", "0.00000E+00", False)],
)  # fmt: skip
def test_modes_of_vibration_and_buckling_have_no_displacements_to_go_by(kind, value, refused, changed):
    (head,) = set(re.findall(r"  100CL  101 1\.000000000 +25 +0 ", MIXED.read_text()))
    path = changed((head, head.replace("1.000000000", value, 1)[:-2] + kind + " "))
    assert len(read_frd(path).fields["DISP"]) == 1
    if refused:
        with pytest.raises(
            ValueError, match=r"step -1 of 1 is a mode of vibration or buckling .*under load: none"
        ):
            read_displacements(path)
    else:
        assert np.array_equal(read_displacements(path).u, read_displacements(MIXED).u)


def test_of_more_than_three_displacements_the_first_are_those_in_space(changed):
    text = MIXED.read_text()
    begin = text.index(" -4  DISP")
    end = text.index(" -3", begin)
    block = text[begin:end].replace(" -5  ALL", " -5  D4          1    1    0    0\n -5  ALL")
    block = re.sub(r"( -1.{46})\n", r"\1 9.00000E+00\n", block)
    path = changed((text[begin:end], block))
    assert read_frd(path).fields["DISP"][0].values.shape == (25, 4)
    assert np.array_equal(read_displacements(path).u, read_displacements(MIXED).u)


def test_nodes_of_networks_beside_solids_need_not_move(changed):
    line = " -1        99   11    0    1\n -2       901       902\n"
    nodes = " -1       901 1.00000E+00 1.00000E+00 0.00000E+00\n -1       902 2.00000E+00 1.00000E+00 0.00000E+00\n"
    text = MIXED.read_text()
    end = text.index(" -3")
    text = text[:end] + nodes + text[end:]
    end = text.index(" -3", text.index("    3C"))
    text = re.sub(r"(    [23]C +)\d+ ", lambda m: m[1][:-1] + "  ", text[:end] + line + text[end:])
    assert read_displacements(changed(text=text)).area() == pytest.approx(read_displacements(MIXED).area())


def test_an_axisymmetric_model_is_told_from_a_plane_one_by_its_input_file(changed):
    path = changed()
    assert read_displacements(path).area() > 0
    path.with_suffix(".inp").write_text("*NODE\n1, 0, 0\n*ELEMENT, TYPE=CAX8R\n1, 1, 2, 3, 4, 5, 6, 7, 8\n")
    with pytest.raises(ValueError, match=r"changed\.frd: has axisymmetric elements \(CAX\)"):
        read_displacements(path)
    path.with_suffix(".inp").write_text("nothing of CalculiX")
    assert read_displacements(path).area() > 0


def test_a_node_that_stands_twice_is_refused(changed):
    text = MIXED.read_text()
    first = text[text.index(" -1") :].split("\n")[0] + "\n"
    text = re.sub(r"(    2C +)25 ", r"\g<1>26 ", text.replace(first, first + first, 1))
    with pytest.raises(ValueError, match=r"the block holds node \d+ more than once"):
        read_frd(changed(text=text))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no CalculiX result file"),
        ("    1C\n    1UUSER\n 9999\n", r"holds no nodes \(2C\)"),
        (
            "    1C\n    2C                             0                                     1\n -3\n 9999\n",
            "no displace",
        ),
        (
            "    1C\n    2C                             1                                     3\n\0\0\n",
            "form '3'",
        ),
        (
            "    1C\n    2C                             1                                     1\n -2\n -3\n",
            "with -1",
        ),
        (
            "    1C\n    2C                             1                                     1\n -1\n -3\n",
            "0 columns",
        ),
        (
            "    1C\n    2C                            1x                                     1\n -3\n",
            "a number is exp",
        ),
    ],
)
def test_files_without_results_are_refused_with_the_reason(text, message, tmp_path):
    (tmp_path / "none.frd").write_text(text)
    with pytest.raises(ValueError, match=rf"none\.frd.*{message}"):
        read_displacements(tmp_path / "none.frd")


@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_damage_is_refused_by_name_or_is_none(data, tmp_path_factory):
    damaged = bytearray(MIXED.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(damaged) - 1))
        new = data.draw(
            st.binary(min_size=0, max_size=3) | st.sampled_from([b"\n", b" -1", b" -3", b"9", b"-", b" "])
        )
        damaged[at : at + data.draw(st.integers(0, 3))] = new
    path = tmp_path_factory.getbasetemp() / "damaged.frd"
    path.write_bytes(bytes(damaged))
    for read in (read_displacements, read_element_results):
        try:
            read(path)
        except ValueError as error:
            assert "damaged.frd" in str(error)
