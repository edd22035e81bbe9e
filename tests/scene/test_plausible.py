"""Values no solid has: what is warned of, and of which real materials nothing is said."""

import inspect
from pathlib import Path

import pytest
from typer.testing import CliRunner

import slmm
from slmm.command.cli import app
from slmm.scene import gallery
from slmm.scene.plausible import UnusualValueWarning, unusual_values

CASES = Path(__file__).parents[3] / "shared" / "cases"
MATERIALS = {  # E (MPa), nu, sigma_c (MPa), K_Ic (MPa sqrt(m)); textbook values
    "soft foam": (0.3, 0.3, 0.1, 0.01),
    "rigid foam": (75.0, 0.32, 1.5, 0.15),
    "natural rubber": (2.0, 0.49, 25.0, 0.2),
    "hydrogel": (0.1, 0.45, 0.05, 0.003),
    "polyethylene": (900.0, 0.42, 25.0, 2.0),
    "polycarbonate": (2300.0, 0.37, 65.0, 3.0),
    "epoxy": (3000.0, 0.38, 80.0, 0.6),
    "oak": (1000.0, 0.3, 8.0, 0.5),
    "concrete": (30000.0, 0.2, 3.0, 1.0),
    "plaster": (5000.0, 0.2, 2.0, 0.15),
    "ice": (9000.0, 0.33, 1.0, 0.1),
    "granite": (50000.0, 0.25, 10.0, 1.5),
    "glass": (70000.0, 0.22, 50.0, 0.75),
    "glass fibre": (72000.0, 0.22, 3500.0, 0.75),
    "polysilicon": (160000.0, 0.22, 2000.0, 1.0),
    "zirconia": (210000.0, 0.31, 900.0, 8.0),
    "diamond": (1.1e6, 0.1, 2800.0, 5.0),
    "aluminium": (70000.0, 0.33, 450.0, 30.0),
    "tough steel": (210000.0, 0.3, 400.0, 250.0),
    "of no scale": (1.0, 0.3, 1.0, 0.03),
}


def of(E, nu, sigma_c, K_Ic, **more):
    return gallery.circular_hole(material={"E": E, "nu": nu, "sigma_c": sigma_c, "K_Ic": K_Ic}, **more)


@pytest.mark.parametrize("name", MATERIALS)
def test_real_materials_pass(name):
    assert unusual_values(of(*MATERIALS[name])) == []


def test_the_gallery_passes():
    scenes = [
        make()
        for name, make in inspect.getmembers(gallery, inspect.isfunction)
        if make.__module__ == gallery.__name__
        and not name.startswith("_")
        and all(
            p.default is not p.empty or p.kind == p.VAR_KEYWORD
            for p in inspect.signature(make).parameters.values()
        )
    ]
    scenes = [scene for scene in scenes if isinstance(scene, slmm.Scene)]
    assert len(scenes) >= 7
    assert [unusual_values(scene) for scene in scenes] == [[]] * len(scenes)
    assert [
        unusual_values(scene.with_(material={"name": n})) for scene in scenes for n in slmm.MATERIALS
    ] == [[]] * (3 * len(scenes))


@pytest.mark.parametrize("name", ["PMMA", "PS", "Al2O3"])
@pytest.mark.parametrize(
    ("factors", "named"),
    [
        ((1e-3, 1, 1), "material."),  # E in GPa
        ((1e6, 1, 1), "material.E"),  # in Pa
        ((1, 1e6, 1), "material.sigma_c"),
        ((1, 1, 1e6), "material.K_Ic"),  # in Pa sqrt(m)
    ],
)
def test_mistaken_units_are_named(name, factors, named):
    material = slmm.Material.from_name(name)
    values = material.E, material.sigma_c, material.K_Ic / 1000**0.5
    E, sigma_c, K_Ic = (value * factor for value, factor in zip(values, factors, strict=True))
    says = unusual_values(of(E, 0.35, sigma_c, K_Ic))
    assert any(text.startswith(named) and "MPa" in text for text in says)


def test_toughness_in_root_millimetres_is_seen_where_no_solid_is_so_tough():
    assert "at most 44.4 MPa sqrt(m)" in unusual_values(of(2960.0, 0.35, 70.5, 62.0))[0]


def test_energy_in_joules_per_square_metre_is_seen():
    (says,) = unusual_values(
        gallery.circular_hole(material={"E": 2960.0, "nu": 0.35, "sigma_c": 70.5, "G_c": 1298.0})
    )
    assert "G_c in N/mm" in says


def test_a_model_in_metres_is_seen():
    scene = gallery.circular_hole(
        plate={"width": 0.1, "height": 0.1},
        holes=[{"shape": "circle", "center": [0.05, 0.05], "radius": 0.02}],
    )
    assert [text.startswith("plate: is 0.1 mm long") for text in unusual_values(scene)] == [True]


def test_the_result_keeps_the_warning_and_the_command_line_says_it():
    with pytest.warns(UnusualValueWarning, match=r"material\.E = 2\.96 MPa"):
        result = slmm.failure_indices(of(2.96, 0.35, 70.5, 1.96), "rankine", positions=2)
    assert "material.E = 2.96 MPa" in result.attrs["warnings"]
    said = CliRunner().invoke(
        app,
        ["initiation", str(next(CASES.glob("20-*")) / "a.toml"), "--method", "rankine", "--positions", "2"],
    )
    assert said.exit_code == 0, said.stderr
    assert said.stderr.count("warning: material.E = 2.96 MPa: is less than 5 times sigma_c") == 1


def test_usual_values_are_computed_without_a_word(recwarn):
    result = slmm.failure_indices(gallery.circular_hole(), "rankine", positions=2)
    assert "warnings" not in result.attrs
    assert not [w for w in recwarn if issubclass(w.category, UnusualValueWarning)]
