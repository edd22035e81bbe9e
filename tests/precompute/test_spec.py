import numpy as np
import pytest

from precompute.spec import PUBLISHED_CURVATURES, SweepSpec, poisson_nodes, read_spec


def test_default_covers_the_published_ranges():
    spec = SweepSpec()
    assert set(PUBLISHED_CURVATURES) <= set(spec.curvature) and len(PUBLISHED_CURVATURES) == 16
    assert (spec.curvature[0], spec.curvature[-1]) == (-1.0, 0.5)
    assert (spec.poisson[0], spec.poisson[-1]) == (-0.9, 0.98)
    assert spec.crack_length[-1] == 1.0
    assert spec.eta[0] == 0.0
    assert spec.eta[-1] == 1.0


def test_poisson_nodes_ascend_and_gather_at_the_ends():
    nodes = np.arctanh(poisson_nodes(9))
    steps = np.diff(nodes)
    assert np.all(steps > 0)
    assert steps[0] < steps[4] > steps[-1]


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        ({"curvature": (0.0, -0.5)}, "curvature"),
        ({"curvature": ()}, "curvature"),
        ({"curvature": (-1.5, 0.0)}, "curvature"),
        ({"curvature": (0.0, 0.6)}, "curvature"),
        ({"curvature": (0.0, float("nan"))}, "curvature"),
        ({"poisson": (0.3, 1.0)}, "poisson"),
        ({"poisson": (-1.0, 0.3)}, "poisson"),
        ({"poisson": (0.3, 0.3)}, "poisson"),
        ({"crack_length": (0.1, 0.2, 0.3)}, "crack_length"),
        ({"crack_length": (0.0, 0.1, 0.2, 0.3)}, "crack_length"),
        ({"crack_length": (0.1, 0.2, 0.3, 1.2)}, "crack_length"),
        ({"crack_length": (0.1, 0.2, 0.3, float("inf"))}, "crack_length"),
        ({"modes": 1}, "modes"),
        ({"modes": 9}, "modes"),
        ({"modes": "all"}, "modes"),
        ({"tip": 0.0}, "tip"),
        ({"tip": float("nan")}, "tip"),
        ({"growth": 1.0}, "growth"),
        ({"coarsest": -0.1}, "coarsest"),
        ({"orders": 1}, "orders"),
        ({"path_points": 3}, "path_points"),
        ({"curvatures": (0.0,)}, "curvatures"),
    ],
)
def test_wrong_settings_are_refused_by_name(settings, named):
    with pytest.raises(ValueError, match=named):
        SweepSpec(**settings)


def test_file_that_is_not_toml_is_refused_by_name(tmp_path):
    path = tmp_path / "spec.toml"
    path.write_text("curvature = [0.0")
    with pytest.raises(ValueError, match=r"spec\.toml"):
        read_spec(path)


def test_fingerprint_follows_what_changes_a_result():
    spec = SweepSpec()
    assert SweepSpec(title="other").fingerprint == spec.fingerprint
    for change in ({"tip": 0.004}, {"poisson": (0.3,)}, {"modes": "published"}, {"path_points": 18}):
        assert SweepSpec(**change).fingerprint != spec.fingerprint
