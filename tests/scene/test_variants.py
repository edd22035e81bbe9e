"""Keys of a scene that are varied: their grammar, and the scenes that come of it."""

import numpy as np
import pytest

from slmm.scene import gallery
from slmm.scene.scene import Scene
from slmm.scene.variants import load_numbers, parsed, values_of, variants_of

BENT = {
    "plate": {"width": 44.0, "height": 10.0},
    "holes": [{"shape": "circle", "center": [22.0, 4.0], "radius": 1.0}],
    "material": {"E": 3000.0, "nu": 0.3, "sigma_c": 50.0, "K_Ic": 1.0},
    "boundary": [
        {"at": [2.0, 0.0], "width": 0.2, "displacement": [0.0, 0.0]},
        {"at": [42.0, 0.0], "width": 0.2, "displacement": ["free", 0.0]},
        {"at": [22.0, 10.0], "width": 0.2, "force": [30.0, -300.0]},
    ],
}


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("a=1", (1.0,)),
        ("a=1, 2.5,3", (1.0, 2.5, 3.0)),
        ("a=0:1:3", (0.0, 0.5, 1.0)),
        ("a=1:0:3", (1.0, 0.5, 0.0)),
        ("a=1e-3:1e-1:3:log,5", (0.001, 0.01, 0.1, 5.0)),
    ],
)
def test_values_are_numbers_ranges_and_ranges_by_factors(text, values):
    assert parsed(text) == ("a", values)


def test_in_python_values_may_be_a_text_a_number_or_any_numbers():
    assert values_of("a", np.linspace(0, 1, 3)) == values_of("a", "0:1:3") == (0.0, 0.5, 1.0)
    assert values_of("a", 3) == (3.0,)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("load.strain", "give KEY=VALUES"),
        ("=1", "give KEY=VALUES"),
        ("a=", "a = '': is no value; give numbers with commas"),
        ("a=1,x", "a = 'x': is no value"),
        ("a=1:2", "a = '1:2': is no value; .*start:stop:count"),
        ("a=1:2:3:lin", "is no value"),
        ("a=1:2:0", "a = 1:2:0: a range of 0 values"),
        ("a=1:2:1", "both ends differ"),
        ("a=0:2:3:log", "two ends above 0"),
        ("a=1:2:1000000", "at most 100000"),
        ("a=1,2,1", "a = 1.0: comes twice"),
        ("a=inf", "must be a finite number"),
    ],
)
def test_what_is_no_value_is_named(text, says):
    with pytest.raises(ValueError, match=says):
        parsed(text)


def test_all_combinations_the_last_key_fastest():
    found = variants_of(
        gallery.circular_hole(),
        {"material.sigma_c": [60, 80], "load.strain": [0.1, 0.2], "material.K_Ic": [1, 2, 3]},
    )
    assert found.shape == (2, 2, 3) and len(found.loaded) == 2 and len(found.made_of) == 6
    assert found.load.reshape(found.shape)[0, :, 0].tolist() == [0, 1]
    made_of = [found.made_of[j].material for j in found.material[:6]]
    assert [material.sigma_c for material in made_of] == [60.0] * 6
    assert [round(material.K_Ic / np.sqrt(1000)) for material in made_of] == [1, 2, 3, 1, 2, 3]


def test_of_a_list_the_largest_component_takes_the_value_and_the_others_follow():
    scene = gallery.circular_hole(load={"strain": [0.01, -0.04, 0.0]})
    whole = variants_of(scene, {"load.strain": [0.08]}).loaded[0].load.strain
    assert whole == (pytest.approx(-0.02), 0.08, 0.0)
    one = variants_of(scene, {"load.strain.2": [0.08], "load.strain.0": [0.5]}).loaded[0].load.strain
    assert one == (0.5, -0.04, 0.08)
    bent = variants_of(Scene.from_dict(BENT), {"boundary.2.force": "-600:-300:2"}).loaded
    assert [each.boundary[2].force for each in bent] == [(60.0, -600.0), (30.0, -300.0)]
    held = variants_of(Scene.from_dict(BENT), {"boundary.1.displacement.1": [0.1]}).loaded[0]
    assert held.boundary[1].displacement == ("free", 0.1)


def test_what_is_not_varied_of_a_named_material_stays():
    PMMA = gallery.circular_hole().material
    stronger = variants_of(gallery.circular_hole(), {"material.sigma_c": [100.0]}).made_of[0].material
    assert (stronger.E, stronger.nu, stronger.sigma_c) == (PMMA.E, PMMA.nu, 100.0)
    assert stronger.G_c == pytest.approx(PMMA.G_c, rel=1e-12)
    # of a name the toughness is what a material keeps (Paper A, section 3.1.1), of constants what was given
    stiffer = variants_of(gallery.circular_hole(), {"material.E": [2 * PMMA.E]}).made_of[0].material
    assert stiffer.K_Ic == pytest.approx(PMMA.K_Ic, rel=1e-12)
    by_energy = gallery.circular_hole(material={"E": 1000.0, "nu": 0.3, "sigma_c": 10.0, "G_c": 0.1})
    assert variants_of(by_energy, {"material.E": [2000.0]}).made_of[0].material.G_c == 0.1
    names = variants_of(by_energy, {"material.name": "PMMA,PS"}).made_of
    assert [each.material.name for each in names] == ["PMMA", "PS"]


@pytest.mark.parametrize(
    ("vary", "says"),
    [
        ({}, "names no key"),
        (
            {"load.stress": [1.0]},
            r"load\.stress: is no key of this scene .* it has material\.name, .*load\.strain$",
        ),
        ({"material.rho": [1.0]}, r"material\.rho: is no key"),
        ({"plate.width": [1.0]}, r"plate\.width: is no key"),
        ({"load.strain.3": [1.0]}, "has 3 components, from 0 to 2"),
        ({"load.strain": [0.0]}, "is zero; without a load"),
        ({"material.E": []}, r"material\.E: has no values"),
        ({"material.E": [-1.0]}, r"material\.E = -1.0: must be greater than 0"),
        ({"material.nu": [0.7]}, r"material\.nu = 0.7: must be less than 0.5"),
        ({"material.E": ["PMMA"]}, "give numbers with commas"),
        ({"material.name": [1.0]}, "must be a name"),
        ({"material.name": ["Wood"]}, "known are PMMA"),
        ({"material.K_Ic": [1.0], "material.G_c": [1.0]}, "contradicts"),
        ({"material.name": ["PS"], "material.E": [1.0]}, "contradicts"),
        ({"load.strain": [1.0], "load.strain.1": [1.0]}, "vary one of them"),
        ({"load.strain": "1:2:400", "material.E": "1:2:400"}, "160000 combinations; at most 100000"),
    ],
)
def test_what_a_scene_does_not_have_is_named_with_what_it_has(vary, says):
    with pytest.raises(ValueError, match=says):
        variants_of(gallery.circular_hole(), vary)


@pytest.mark.parametrize(
    ("key", "says"),
    [
        ("boundary.3.force", r"it has .*boundary\.2\.force"),
        ("boundary.2.pressure", "is no key"),
        ("load.strain", "is no key"),
        ("boundary.1.displacement.0", '"free" that way'),
        ("boundary.1.displacement", r"is zero, without a direction; name a component"),
    ],
)
def test_conditions_are_numbered_as_in_the_file(key, says):
    with pytest.raises(ValueError, match=says):
        variants_of(Scene.from_dict(BENT), {key: [1.0]})


def test_numbers_of_a_load_are_what_is_given_and_what_acts():
    given, acting = load_numbers(gallery.circular_hole(load={"stress": 3.0}))
    assert not given.any() and acting.max() == 3.0
    given, acting = load_numbers(Scene.from_dict(BENT))
    assert not given.any() and sorted(acting[acting != 0]) == [-300.0, 30.0]
