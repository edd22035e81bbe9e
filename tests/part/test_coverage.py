import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from slmm.part.coverage import area_fraction
from slmm.part.shapes import circle


def by_clipping(polygons, width, height, nx, ny):
    union = shapely.union_all([shapely.Polygon(p) for p in polygons])
    hx, hy = width / nx, height / ny
    cells = [[shapely.box(j * hx, i * hy, (j + 1) * hx, (i + 1) * hy) for j in range(nx)] for i in range(ny)]
    return shapely.area(shapely.intersection(np.array(cells), union)) / (hx * hy)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 4), st.integers(1, 15), st.integers(1, 15))
def test_equals_the_clipped_areas(seed, number, nx, ny):
    rng = np.random.default_rng(seed)
    polygons = []
    for _ in range(number):  # star-shaped, anywhere in and around the plate, either sense of rotation
        angle = np.sort(rng.uniform(0, 2 * np.pi, 9)) * rng.choice([-1, 1])
        radius = rng.uniform(0.2, 3, 9)
        centre = rng.uniform(-1, 6, 2)
        polygon = centre + np.stack([radius * np.cos(angle), radius * np.sin(angle)], -1)
        if shapely.Polygon(polygon).is_valid:
            polygons.append(polygon)
    if polygons:
        np.testing.assert_allclose(
            area_fraction(polygons, 5.0, 4.0, nx, ny), by_clipping(polygons, 5.0, 4.0, nx, ny), atol=1e-12
        )


def test_rectangle_on_and_beside_the_grid_lines():
    square = np.array([[1.0, 1.0], [3.0, 1.0], [3.0, 2.5], [1.0, 2.5]])
    covered = area_fraction([square], 4.0, 4.0, 4, 4)
    np.testing.assert_allclose(covered, [[0, 0, 0, 0], [0, 1, 1, 0], [0, 0.5, 0.5, 0], [0, 0, 0, 0]])


def test_polygon_that_covers_the_plate_and_no_polygon():
    around = np.array([[-5.0, -5.0], [9.0, -5.0], [9.0, 9.0], [-5.0, 9.0]])
    assert np.all(area_fraction([around], 4.0, 4.0, 3, 5) == 1)
    assert np.all(area_fraction([], 4.0, 4.0, 3, 5) == 0)


def test_circle_area_is_that_of_its_polygon():
    polygon = circle((50, 50), 20)
    covered = area_fraction([polygon], 100.0, 100.0, 250, 250)
    assert covered.sum() * 0.16 == pytest.approx(shapely.Polygon(polygon).area, rel=1e-12)
    assert covered[125, 125] == pytest.approx(1, abs=1e-12)


def test_overlap_counts_once():
    covered = area_fraction([circle((4, 5), 2), circle((5, 5), 2), circle((5, 5), 1)], 10.0, 10.0, 20, 20)
    union = shapely.union(shapely.Polygon(circle((4, 5), 2)), shapely.Polygon(circle((5, 5), 2)))
    assert covered.sum() / 4 == pytest.approx(union.area, rel=1e-12)


@pytest.mark.parametrize(
    ("polygon", "message"),
    [
        ([[0, 0], [1, 1]], "n >= 3"),
        ([[0, 0], [1, 1], [1, np.nan]], "not finite"),
        ([[0, 0], [1, 1], [1, 0], [0, 1]], "not simple"),
    ],
)
def test_bad_polygons_are_named(polygon, message):
    with pytest.raises(ValueError, match=message):
        area_fraction([np.array(polygon, dtype=float)], 1.0, 1.0, 4, 4)
