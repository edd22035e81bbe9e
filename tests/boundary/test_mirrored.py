"""Jumps beside a free line or circle: no force on it, and a field that is one."""

import numpy as np
import pytest

from slmm.boundary.mirrored import Tangent, surface_fields

MOUTH, INWARDS, KAPPA = 3 + 1j, np.exp(0.3j), 2.0
JUMP, ALONG = MOUTH + 0.3 * np.exp(0.5j), np.exp(1.1j)
SURFACES = {
    "line": Tangent.line(MOUTH, INWARDS),
    "hole": Tangent.circle(MOUTH, INWARDS, -0.5),
    "disk": Tangent.circle(MOUTH, INWARDS, 0.5),
}


def fields(tangent, z, along=1.0):
    z = np.atleast_1d(np.asarray(z, dtype=complex))
    jump = np.array([JUMP - tangent.origin])
    return surface_fields(
        z - tangent.origin, np.full(len(z), along, dtype=complex), jump, ALONG, KAPPA, *tangent[1:]
    )


def on_surface(name):
    tangent = SURFACES[name]
    if name == "line":
        return MOUTH + 1j * INWARDS * np.linspace(-5.0, 5.0, 11)
    return tangent.origin + 2.0 * np.exp(1j * np.linspace(0.0, 6.0, 11))


@pytest.mark.parametrize("name", SURFACES)
def test_the_surface_is_free_of_forces(name):
    _, F, _ = fields(SURFACES[name], on_surface(name))
    assert np.abs(F - F[0]).max() < 1e-13


@pytest.mark.parametrize("name", SURFACES)
def test_tractions_are_the_change_of_the_resultant(name):
    z, along, step = MOUTH + 0.7 * INWARDS + 0.1j, np.exp(0.4j), 1e-5
    ahead, back = (fields(SURFACES[name], z + side * step * along, along)[1] for side in (1, -1))
    change = (ahead - back) / (2 * step)
    assert fields(SURFACES[name], z, along)[2] == pytest.approx(-1j * change, rel=1e-7)


@pytest.mark.parametrize("name", SURFACES)
def test_jumps_feel_each_other_alike(name):
    """Betti: the traction at one place by a jump at another is that the other way round."""
    tangent, other, along = SURFACES[name], MOUTH + 0.5 * np.exp(0.1j), np.exp(-0.4j)

    def felt(at, e, by, e_by):
        jump = np.array([by - tangent.origin])
        _, _, T = surface_fields(
            np.array([at - tangent.origin]), np.array([e]), jump, e_by, KAPPA, *tangent[1:]
        )
        # on the left of e, along it and across
        local = -np.conj(e) * T[0]
        return np.array([local.real, local.imag])

    there, back = felt(other, along, JUMP, ALONG), felt(JUMP, ALONG, other, along)
    assert there == pytest.approx(back.T, rel=1e-12)


def test_a_large_hole_is_a_line():
    z = MOUTH + 0.4 * INWARDS + 0.2j
    by_circle = fields(Tangent.circle(MOUTH, INWARDS, -1e-5), z)
    for one, other in zip(by_circle[1:], fields(SURFACES["line"], z)[1:], strict=True):
        assert one == pytest.approx(other, rel=1e-4)


def test_without_the_pole_the_surface_is_free_to_the_third_order_about_the_mouth():
    """Half as far away an eighth of the resultant is left."""
    hole = SURFACES["hole"].without_pole(MOUTH)
    turns = 0.02 * 0.5 ** np.arange(3)
    at = hole.origin + 2.0 * INWARDS * np.exp(1j * np.append(turns, 0.0))
    _, F, _ = fields(hole, at)
    left = np.abs(F[:-1] - F[-1]).max(axis=1)
    assert np.log2(left[:-1] / left[1:]) == pytest.approx(3.0, abs=0.1)


def test_singular_where_images_are_and_at_a_holes_centre():
    at = np.array([MOUTH + 0.5 * INWARDS])
    hole = SURFACES["hole"]
    # 2.5 from the centre of a circle of 2: its image is at 1.6
    assert hole.singular(at) == pytest.approx([hole.origin + 1.6 * INWARDS, hole.origin])
    assert hole.without_pole(MOUTH).singular(at) == pytest.approx([hole.origin + 1.6 * INWARDS])
    assert SURFACES["line"].singular(at) == pytest.approx([MOUTH - 0.5 * INWARDS])
