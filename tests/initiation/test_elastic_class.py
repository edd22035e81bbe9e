"""Loads and stiffnesses as other strengths and toughnesses under one load: the index stays what it was."""

import numpy as np
import pytest

from slmm import failure_indices
from slmm.initiation.elastic_class import elastic_classes
from slmm.scene import gallery
from slmm.scene.variants import variants_of

CELL = {"points": [[68.0, 58.0]], "voxels": 10_000}


@pytest.mark.parametrize("load", [{"strain": [0.0, 0.02, 0.01]}, {"stress": 20.0}, {"displacement": 0.4}])
def test_a_variant_is_as_critical_as_the_material_that_stands_for_it(load):
    kind = next(iter(load))
    sizes = {"strain": [0.01, 0.05], "stress": [15.0, 40.0], "displacement": [0.2, 1.0]}[kind]
    scene = gallery.circular_hole(load=load, analysis=CELL)
    vary = {f"load.{kind}": sizes, "material.E": [1500.0, 4000.0], "material.sigma_c": [50.0]}
    variants = variants_of(scene, vary)
    (elastic,) = elastic_classes(variants)
    assert elastic.members.tolist() == [0, 1, 2, 3]
    for k, material in enumerate(elastic.materials):
        own = variants.loaded[variants.load[k]].with_(
            material=variants.made_of[variants.material[k]].material_table.model_dump(exclude_none=True)
        )
        there, here = (
            failure_indices(one, "slmm+ac").isel(position=0) for one in (elastic.of(material), own)
        )
        assert float(there.failure_index) == pytest.approx(float(here.failure_index), rel=1e-9)
        assert float(there.crack_length) == pytest.approx(float(here.crack_length), rel=1e-9)
        assert material.irwin_length == pytest.approx(own.material.irwin_length, rel=1e-12)


def test_another_direction_sign_or_lateral_contraction_is_another_field():
    scene = gallery.circular_hole(load={"strain": [0.01, 0.04, 0.0]})
    for vary, count in (
        ({"load.strain": [0.1, 0.2, -0.1]}, 2),
        ({"load.strain.0": [0.1, 0.2]}, 2),
        ({"material.nu": [0.2, 0.3, 0.4], "material.sigma_c": [50.0, 60.0]}, 3),
    ):
        found = elastic_classes(variants_of(scene, vary))
        assert len(found) == count
        assert sorted(np.concatenate([each.members for each in found])) == list(
            range(sum(len(each.members) for each in found))
        )
