"""Of an input file, what elements are made of is known; what is not linear elastic is not taken for it."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.fem.elasticity import Elasticity
from slmm.fem.inp import read_inp

DATA = Path(__file__).parents[1] / "data"

MODEL = """\
** a comment, and blank lines

*Heading
 Two bricks, ** and a wedge
*Node, nset=All
1, 0., 0., 0.
 7 , 1.5,, 2e-1
8, 3, 4
*Include, input=parts/elements.inp
*ELSET, ELSET=odd, GENERATE
1, 5, 2
*elset, elset=Some
ODD, 2
*Material, name=Steel
** comments may stand anywhere
*Density
7.8e-9
*Elastic, type=isotropic
210000., 0.3
*Solid Section, elset=Bricks, material=steel
*Solid Section, elset=Some, material=STEEL,
  orientation=Or
2.5,
*Step, inc=100
*Static
*End Step
"""
ELEMENTS = """\
*ELEMENT, TYPE=C3D20R, ELSET=BRICKS
4, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15,
16, 17, 18, 19, 20
5, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30
31, 32, 33, 34, 35, 36, 37, 38, 39, 40
*ELEMENT, TYPE=cps4
1, 1, 2, 3, 4
*ELEMENT, TYPE=SPRINGX
2, 1, 2,
3, 4
3, 5
"""


@pytest.fixture
def written(tmp_path):
    def write(text=MODEL, elements=ELEMENTS):
        (tmp_path / "parts").mkdir(exist_ok=True)
        (tmp_path / "parts" / "elements.inp").write_text(elements)
        (tmp_path / "model.inp").write_text(text)
        return tmp_path / "model.inp"

    return write


def test_elements_sections_and_materials_are_read_across_files_lines_and_capitals(written):
    model = read_inp(written())
    assert {kind: ids.tolist() for kind, ids in model.cell_ids.items()} == {
        "C3D20R": [4, 5],
        "CPS4": [1],
        "SPRINGX": [2, 3],
    }
    assert np.array_equal(model.cells["C3D20R"], np.arange(1, 41).reshape(2, 20))
    assert "SPRINGX" not in model.cells
    assert model.node_ids.tolist() == [1, 7, 8]
    assert model.nodes.tolist() == [[0, 0, 0], [1.5, 0, 0.2], [3, 4, 0]]
    assert model.types_of([5, 1, 2, 4]).tolist() == ["C3D20R", "CPS4", "SPRINGX", "C3D20R"]
    assert [(s.elements.tolist(), s.material, s.thickness) for s in model.sections] == [
        ([4, 5], "STEEL", None),
        ([1, 2, 3, 5], "STEEL", 2.5),
    ]
    assert model.materials == {"STEEL": Elasticity(210e3, 0.3)}
    assert not model.nlgeom


def test_the_last_section_that_names_an_element_is_its_own(written):
    model = read_inp(written())
    assert model.section_of([4, 5, 1]).tolist() == [0, 1, 1]
    with pytest.raises(ValueError, match=r"model\.inp: has no element 6 \(1 of 2 such"):
        model.types_of([1, 6])
    with pytest.raises(ValueError, match=r"element 9 has no \*SOLID SECTION"):
        model.section_of([9])


@given(widths=st.lists(st.integers(1, 10), min_size=3, max_size=12), data=st.data())
def test_an_element_may_go_on_in_the_next_line_anywhere(widths, data, tmp_path_factory):
    numbers = [str(k) for k in range(100, 121)]
    lines, start = [], 0
    for width in [*widths, 21]:
        lines.append(", ".join(numbers[start : start + width]) + data.draw(st.sampled_from(["", ",", " , "])))
        start += width
    path = tmp_path_factory.getbasetemp() / "element.inp"
    path.write_text("*ELEMENT, TYPE=C3D20\n" + "\n".join(line for line in lines if line[:1].isdigit()) + "\n")
    model = read_inp(path)
    assert model.cell_ids["C3D20"].tolist() == [100]
    assert model.cells["C3D20"].tolist() == [list(range(101, 121))]


@pytest.mark.parametrize(
    ("option", "reason"),
    [
        ("*PLASTIC\n300, 0", "STEEL has *PLASTIC"),
        ("*Expansion\n1.2e-5", "STEEL has *EXPANSION"),
        ("*User Material, constants=2\n1, 2", "STEEL has *USER MATERIAL"),
        ("*SOMETHING NEW\n1", "STEEL has *SOMETHING NEW"),
        (
            "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1,1,1,.3,.3,.3,1,1\n1",
            "*ELASTIC, TYPE=ENGINEERINGCONSTANTS",
        ),
        ("*ELASTIC\n210e3, 0.3, 20\n190e3, 0.3, 300", "for 2 temperatures"),
    ],
)
def test_a_material_with_more_than_linear_elasticity_is_unknown(option, reason, written):
    model = read_inp(written(MODEL.replace("*Solid Section, elset=B", f"{option}\n*Solid Section, elset=B")))
    assert model.materials == {"STEEL": None}
    assert reason in model.reasons["STEEL"]


@pytest.mark.parametrize(
    "keyword",
    [
        "*INITIAL CONDITIONS, TYPE=STRESS\nBRICKS, 1, 2, 3, 4, 5, 6",
        "*MODEL CHANGE, TYPE=ELEMENT, REMOVE\nBRICKS",
        "*CHANGE MATERIAL, NAME=STEEL",
    ],
)
def test_strains_that_displacements_do_not_tell_of_make_all_elasticity_unknown(keyword, written):
    model = read_inp(written(MODEL.replace("*Static", f"{keyword}\n*Static")))
    assert model.materials == {"STEEL": None}
    assert keyword.split(",")[0] in model.reasons["STEEL"]


def test_initial_temperatures_strain_nothing_without_expansion(written):
    conditions = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20\n*Step"
    assert read_inp(written(MODEL.replace("*Step", conditions))).materials["STEEL"] is not None


@pytest.mark.parametrize(
    ("parameter", "nonlinear"),
    [("", False), (", NLGEOM", True), (", nlgeom = yes", True), (", NLGEOM=NO", False)],
)
def test_any_step_with_nlgeom_makes_the_analysis_nonlinear(parameter, nonlinear, written):
    steps = MODEL + f"*STEP{parameter}\n*STATIC\n*END STEP\n*STEP\n*END STEP\n"
    assert read_inp(written(steps)).nlgeom is nonlinear


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("*Include, input=parts/elements.inp", "*Include", r"model\.inp, line 9: \*INCLUDE has no INPUT"),
        ("parts/elements.inp", "none.inp", r"line 9: .*none\.inp: no such file"),
        ("parts/elements.inp", "model.inp", r"line 9: .*model\.inp includes itself"),
        ("1, 5, 2", "1, 5, 0", r"line 11: '1, 5, 0': first, last"),
        ("1, 5, 2", "1, x, 2", r"line 11: '1, x, 2': whole numbers"),
        ("ODD, 2", "EVEN, 2", r"line 13: there is no element set 'EVEN'"),
        ("8, 3, 4", "8, 3, four", r"line 8: '8, 3, four': numbers"),
        ("210000., 0.3", "210000.", r"\*ELASTIC needs Young"),
        ("210000., 0.3", "210000., 0.5", r"line 19: nu = 0.5"),
        (
            "elset=Bricks, material=steel",
            "elset=Rocks, material=steel",
            r"line 20: there is no element set ROCKS",
        ),
        (
            "elset=Bricks, material=steel",
            "elset=Bricks, material=wood",
            r"line 20: there is no material WOOD",
        ),
        ("elset=Bricks, material=steel", "elset=Bricks", r"line 20: \*SOLID SECTION has no MATERIAL"),
        ("*Static", "*Part, name=P", r"line 25: \*PART: parts and instances are not read"),
        ("*Node, nset=All", "*Node, system=C", r"line 5: SYSTEM=C"),
        ("** a comment", "a comment", r"line 1: 'a comment.*no keyword stands before it"),
    ],
)
def test_what_is_wrong_is_named_with_file_and_line(old, new, message, written):
    assert MODEL.count(old) == 1
    with pytest.raises(ValueError, match=message):
        read_inp(written(MODEL.replace(old, new)))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("TYPE=C3D20R, ", "", r"elements\.inp, line 1: \*ELEMENT has no TYPE"),
        ("38, 39, 40", "38, 39", r"elements\.inp, line 5: element 5 has 19 nodes: C3D20R has 20"),
        ("1, 1, 2, 3, 4", "1, 1, 2, 3, 4, 5", r"elements\.inp, line 7: element 1 has 5 nodes: CPS4 has 4"),
        ("1, 1, 2, 3, 4", "4, 1, 2, 3, 4", r"model\.inp: element 4 is defined more than once"),
    ],
)
def test_what_is_wrong_in_an_included_file_is_named_there(old, new, message, written):
    with pytest.raises(ValueError, match=message):
        read_inp(written(elements=ELEMENTS.replace(old, new)))


@pytest.mark.parametrize("path", sorted(DATA.glob("*.inp")), ids=lambda path: path.name)
def test_models_that_calculix_has_solved_are_linear_elastic(path):
    model = read_inp(path)
    assert not model.nlgeom and not model.reasons
    ids = np.concatenate([*model.cell_ids.values()])
    assert (model.section_of(ids) >= 0).all()
    used = np.unique(np.concatenate([nodes.ravel() for nodes in model.cells.values()]))
    assert np.isin(used, model.node_ids).all()
