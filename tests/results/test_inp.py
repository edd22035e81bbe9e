"""Of an input file, what elements are made of is known; what is not linear elastic is not taken for it."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slmm.mechanics.elasticity import Elasticity
from slmm.results.inp import read_inp

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
        (
            "parts/elements.inp",
            "../elements.inp",
            r"line 9: .*only files in the folder of model\.inp, or below",
        ),
        (
            "parts/elements.inp",
            "/etc/hostname",
            r"line 9: .*only files in the folder of model\.inp, or below",
        ),
        ("parts/elements.inp", "x" * 300, r"line 9: .*OSError"),
        ("parts/elements.inp", "a\0b", r"line 9: .*no name of a file"),
        ("1, 5, 2", "1, 6", r"line 11: '1, 6': names elements that the file does not have: the last is 5"),
        ("1, 5, 2", "1, 300000000", r"line 11: '1, 300000000': names elements"),
        ("1, 5, 2", "1, 100000000000", r"line 11: '1, 100000000000': names elements"),
        ("ODD, 2", "9" * 19 + ", 2", r"line 13: '9{19}': whole numbers"),
        ("8, 3, 4", "8, nan, 4", r"line 8: '8, nan, 4': numbers"),
        ("8, 3, 4", "8, 1d999, 4", r"line 8: '8, 1d999, 4': numbers"),
        ("8, 3, 4", "8, 1_0, 4", r"line 8: '8, 1_0, 4': numbers"),
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
        ("1, 1, 2, 3, 4", "1, 1" + "0" * 4300, r"elements\.inp, line 7: '1, 10+\.\.\.': whole numbers"),
        ("1, 1, 2, 3, 4", "4, 1, 2, 3, 4", r"model\.inp: element 4 is defined more than once"),
    ],
)
def test_what_is_wrong_in_an_included_file_is_named_there(old, new, message, written):
    with pytest.raises(ValueError, match=message):
        read_inp(written(elements=ELEMENTS.replace(old, new)))


def test_what_stands_before_the_first_keyword_is_passed_over_and_no_keyword_at_all_is_refused(
    written, tmp_path
):
    for junk in ("a title\n1, 2, 3\n", "\ufeff", "\r\n", "* * a comment\n"):
        assert read_inp(written(junk + MODEL)).cell_ids.keys() == {"C3D20R", "CPS4", "SPRINGX"}
    for nothing in ("", "1, 2, 3\n", "** only\n"):
        (tmp_path / "nothing.inp").write_text(nothing)
        with pytest.raises(ValueError, match=r"nothing\.inp: holds no keyword"):
            read_inp(tmp_path / "nothing.inp")


def test_keywords_may_stand_in_any_order_as_calculix_sorts_them(written):
    begin, end = MODEL.index("*Material"), MODEL.index("*Solid Section")
    material = MODEL[begin:end]
    late = MODEL.replace(material, "").replace("*Step", material + "*Step")
    apart = MODEL.replace("*Elastic", "*Node\n9, 1, 1\n*Elastic")
    assert (
        read_inp(written(late)).materials
        == read_inp(written(apart)).materials
        == {"STEEL": Elasticity(210e3, 0.3)}
    )
    sets = MODEL.replace("*ELSET, ELSET=odd, GENERATE\n1, 5, 2\n", "*Elset, elset=odd\nBricks, 1, 3, 99\n", 1)
    include = "*Include, input=parts/elements.inp\n"
    sets = sets.replace(include, "").replace("*Step", include + "*Step")
    section = read_inp(written(sets)).section_of([1, 2, 3, 4, 5])
    assert section.tolist() == [1, 1, 1, 1, 1]


def test_a_material_may_become_plastic_after_other_keywords(written):
    model = read_inp(written(MODEL.replace("*Step", "*Plastic\n300, 0\n*Step")))
    assert model.reasons == {"STEEL": "STEEL has *PLASTIC"}


def test_elements_of_other_types_end_where_their_nodes_do(written):
    elements = (
        "*ELEMENT, TYPE=S8R\n1, 1, 2, 3, 4\n5, 6, 7, 8\n2, 1, 2, 3, 4, 5, 6, 7, 8\n*ELEMENT, TYPE=D\n3, , 4, 5\n"
        "*USER ELEMENT, TYPE=U7, NODES=5, INTEGRATION POINTS=1, MAXDOF=3\n*ELEMENT, TYPE=U7\n4, 1, 2, 3\n4, 5\n"
        "*ELEMENT, TYPE=DC3D4\n5, 1, 2, 3, 4, 99\n"
    )
    model = read_inp(written(MODEL.replace("Bricks", "odd"), elements))
    assert {kind: ids.tolist() for kind, ids in model.cell_ids.items()} == {
        "S8R": [1, 2], "D": [3], "U7": [4], "C3D4": [5]
    }  # fmt: skip
    assert model.cells["C3D4"].tolist() == [[1, 2, 3, 4]]


@pytest.mark.parametrize(
    ("keyword", "reason"),
    [
        ("*Shell section, composite, elset=odd\n1, , steel", "SHELL SECTION, COMPOSITE"),
        ("*Refine mesh, limit=50.\nS", "REFINE MESH"),
        ("*Model change, type=element, remove\n1", "MODEL CHANGE"),
        ("*Node file, global=no\nU", "GLOBAL=NO"),
        ("*Solid section, elset=odd, material=steel, nodal thickness\n1.", "NODAL THICKNESS"),
    ],
)
def test_what_makes_results_other_than_those_of_the_elements_is_kept(keyword, reason, written):
    (found,) = read_inp(written(MODEL.replace("*Static", f"*Static\n{keyword}"))).unlike
    assert reason in found
    assert not read_inp(
        written(MODEL.replace("*Static", "*Model change, type=contact pair, remove\nA, B"))
    ).unlike


def test_included_files_lie_beside_the_model_as_calculix_finds_them_or_beside_the_file_that_names_them(
    written,
):
    path = written(elements="*INCLUDE, INPUT=more.inp\n" + ELEMENTS)
    (path.parent / "parts" / "more.inp").write_text("*NODE\n99, 1, 1\n")
    assert 99 in read_inp(path).node_ids
    (path.parent / "more.inp").write_text("*NODE\n98, 1, 1\n")
    assert 98 in read_inp(path).node_ids and 99 not in read_inp(path).node_ids


def test_links_that_lead_out_of_the_folder_are_not_followed(written, tmp_path_factory):
    other = tmp_path_factory.mktemp("other") / "elements.inp"
    other.write_text(ELEMENTS)
    path = written()
    (path.parent / "parts" / "elements.inp").unlink()
    (path.parent / "parts" / "elements.inp").symlink_to(other)
    with pytest.raises(ValueError, match=r"line 9: .*only files in the folder"):
        read_inp(path)


def test_files_that_include_each_other_are_refused_however_they_do(written, tmp_path):
    with pytest.raises(ValueError, match=r"elements\.inp, line 1: .*model\.inp includes itself"):
        read_inp(written(elements="*include, input=model.inp\n"))
    path = written(elements="*include, input=0.inp\n")
    for k in range(12):
        (tmp_path / f"{k}.inp").write_text(f"*include, input={k + 1}.inp\n" * 2)
    with pytest.raises(ValueError, match=r"7\.inp, line 1: \*INCLUDE within more than 9 files"):
        read_inp(path)
    for k in range(3, 7):
        (tmp_path / f"{k}.inp").write_text(f"*include, input={k + 1}.inp\n" * 8)
    (tmp_path / "7.inp").write_text("*node\n")
    with pytest.raises(ValueError, match=r"\.inp, line \d+: more than 1000 files are included"):
        read_inp(path)


@pytest.mark.parametrize("path", sorted(DATA.glob("*.inp")), ids=lambda path: path.name)
def test_models_that_calculix_has_solved_are_linear_elastic(path):
    model = read_inp(path)
    assert not model.nlgeom and not model.reasons
    ids = np.concatenate([*model.cell_ids.values()])
    assert (model.section_of(ids) >= 0).all()
    used = np.unique(np.concatenate([nodes.ravel() for nodes in model.cells.values()]))
    assert np.isin(used, model.node_ids).all()
