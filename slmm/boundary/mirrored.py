"""Displacement jumps beside a free line or circle: closed forms, by reflection of Muskhelishvili's potentials.

A jump g along dtau at tau has phi = A/(tau - z) and psi = B/(tau - z) - A conj(tau)/(tau - z)^2 with
A = g dtau/(2 pi i) and B = Im(g conj(dtau))/pi. On the surface conj(z) = y(z): y = R^2/z on a circle about the origin,
y = conj(t)^2 z on a line through it along t. The reflected potentials

    phi_1 = -(z conj(phi)'(y) + conj(psi)(y)) + c z,    psi_1 = -conj(phi)(y) - y (phi_1' + conj(c))

leave the resultant force phi + z conj(phi') + conj(psi) constant along it. c takes away what would grow far from a
hole, or at the centre of a disk (N. I. Muskhelishvili, Some basic problems of the mathematical theory of elasticity,
1953). psi_1 has a pole at the centre of a hole. Where the true surface leaves there material, its Taylor polynomial
about the mouth stands for it: what that leaves on the surface is small beside the mouth.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from slmm.boundary.rules import Complex


class Tangent(NamedTuple):
    """The line or circle that stands for a surface about a mouth.

    Attributes
    ----------
    origin : complex
        The centre, or the mouth on a line, mm.
    squared : complex
        R^2, mm^2, or conj(t)^2.
    side : int
        1 where the material is around the circle, -1 where it is within, 0 of a line.
    mouth : complex
        From the centre, mm, where the pole there has a polynomial in its place; else nothing.
    """

    origin: complex
    squared: complex
    side: int
    mouth: complex = 0j

    def without_pole(self, mouth: complex) -> Tangent:
        """The same with no singularity at the centre."""
        return self._replace(mouth=mouth - self.origin)

    @classmethod
    def circle(cls, mouth: complex, inwards: complex, curvature: float) -> Tangent:
        """At a mouth, with the unit normal into the material; curvature (1/mm) is negative at a hole."""
        return cls(mouth + inwards / curvature, complex(curvature**-2), -1 if curvature > 0 else 1)

    @classmethod
    def line(cls, mouth: complex, inwards: complex) -> Tangent:
        """Across the normal."""
        return cls(mouth, (1j * inwards).conjugate() ** 2, 0)

    def image(self, z: Complex) -> Complex:
        """Where points (k,) are reflected to, mm."""
        away = z - self.origin
        return self.origin + np.conj(self.squared * away if self.side == 0 else self.squared / away)

    def singular(self, along: Complex) -> Complex:
        """Where the reflected fields of jumps at points (k,) are singular, mm."""
        images = self.image(along)
        return np.append(images, self.origin) if self.side == 1 and not self.mouth else images


@njit(cache=True, error_model="numpy")
def _inverse(z):
    """1/z, by products alone."""
    r = 1.0 / (z.real * z.real + z.imag * z.imag)
    return complex(z.real * r, -z.imag * r)


@njit(cache=True)
def _source(e, part):
    """A and B of a unit jump along e, or across, to the left."""
    along = e * e / (2 * np.pi)
    return (along, 1 / np.pi) if part else (-1j * along, 0.0)


@njit(cache=True, error_model="numpy")
def _conjugate(z, squared, side):
    """y and its two derivatives."""
    if side == 0:
        return squared * z, squared, 0.0j
    over = _inverse(z)
    y = squared * over
    return y, -y * over, 2 * y * over * over


@njit(cache=True, error_model="numpy")
def _balance(A, B, tau, squared, side):
    """c."""
    if side == 0:
        return 0.0j
    if side < 0:
        return complex(-0.5 * B / squared.real, 0.0)
    return np.conj(A / (tau * tau))


@njit(cache=True, error_model="numpy")
def _weights(z, tau, y, y1, y2):
    """Of conj(A) in -phi_1 and its two derivatives, and of B."""
    m = _inverse(np.conj(tau) - y)
    square = m * m
    m1 = square * y1
    m2 = 2 * m * m1 * y1 + square * y2
    gap = z - tau
    twice = 2 * gap * m
    return (
        gap * square,
        square + twice * m1,
        4 * m * m1 + 2 * gap * m1 * m1 + twice * m2,
        m,
        m1,
        m2,
    )


@njit(cache=True, error_model="numpy")
def _without_pole(z, squared, mouth):
    """R^2/z less its polynomial about the mouth, and its derivative."""
    if mouth == 0:
        return 0.0j, 0.0j
    over, back = _inverse(mouth), _inverse(z)
    share = 1 - z * over
    return squared * (back - over * (1 + share + share * share)), squared * (
        over * over * (1 + 2 * share) - back * back
    )


@njit(cache=True, error_model="numpy")
def surface_fields(z, tangent, tau, e, kappa, squared, side, mouth):
    """What unit jumps on a line along e at its points tau (q,), beside the surface, cause at points (n,).

    Returns
    -------
    w, F, T : ndarray, shape (n, 2 q)
        2 mu times the displacement, the resultant force and the traction on the right of ``tangent`` (n,), of a jump
        along the line and one across it in turn.
    """
    n, q = len(z), len(tau)
    w = np.empty((n, 2 * q), dtype=np.complex128)
    F = np.empty((n, 2 * q), dtype=np.complex128)
    T = np.empty((n, 2 * q), dtype=np.complex128)
    for i in range(n):
        at, t = z[i], tangent[i]
        here, turned = np.conj(at), -1j * np.conj(t)
        y, y1, y2 = _conjugate(at, squared, side)
        less, less1 = _without_pole(at, squared, mouth)
        for k in range(q):
            p0, p1, p2, m, m1, m2 = _weights(at, tau[k], y, y1, y2)
            over = _inverse(tau[k] - at)
            square = over * over
            cube = 2 * square * over
            mirrored = np.conj(tau[k])
            for part in range(2):
                A, B = _source(e, part)
                c = _balance(A, B, tau[k], squared, side)
                back = np.conj(A)
                free1, phi2 = -(back * p1 + B * m1), -(back * p2 + B * m2)
                held = free1 + 2 * c.real
                phi = A * over - (back * p0 + B * m) + c * at
                phi1 = A * square + free1 + c
                pole = 2 * c.real + B / squared.real
                psi = B * over - A * mirrored * square - back * m - y * held + less * pole
                psi1 = B * square - A * mirrored * cube - back * m1 - y1 * held - y * phi2 + less1 * pole
                by = at * np.conj(phi1) + np.conj(psi)
                j = 2 * k + part
                w[i, j] = kappa * phi - by
                F[i, j] = phi + by
                T[i, j] = -2j * t * phi1.real + turned * np.conj(here * (phi2 + A * cube) + psi1)
    return w, F, T


@njit(cache=True, error_model="numpy")
def image_tractions(z, e, tau, squared, side, mouth):
    """Tractions on the left of a line along e at points (n,) of it, by what is reflected of unit jumps on it.

    Shape (n, q, 2, 2): at each point along the line and across, by jumps along it at tau (q,) and across.
    """
    n, q = len(z), len(tau)
    T = np.empty((n, q, 2, 2))
    turned = np.conj(e) ** 2
    for i in range(n):
        here = np.conj(z[i])
        y, y1, y2 = _conjugate(z[i], squared, side)
        _, less1 = _without_pole(z[i], squared, mouth)
        for k in range(q):
            _, p1, p2, _, m1, m2 = _weights(z[i], tau[k], y, y1, y2)
            for part in range(2):
                A, B = _source(e, part)
                c = _balance(A, B, tau[k], squared, side)
                back = np.conj(A)
                free1, phi2 = -(back * p1 + B * m1), -(back * p2 + B * m2)
                pole = 2 * c.real + B / squared.real
                psi1 = -back * m1 - y1 * (free1 + 2 * c.real) - y * phi2 + less1 * pole
                change = 2 * (free1 + c).real + turned * np.conj(here * phi2 + psi1)
                T[i, k, 0, part] = -change.imag
                T[i, k, 1, part] = change.real
    return T
