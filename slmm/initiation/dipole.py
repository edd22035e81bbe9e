"""Closed-form field of an infinitesimal piece of open crack beside a free surface: a dislocation dipole.

A crack is a distribution of dislocations; a piece of it that opens (or slides) by a jump over a short length is a
dipole of two of them. Its field in the unbounded plane is singular at the piece; beside a circular hole or a
straight edge that of the mirrored piece is added such that the surface stays free (Muskhelishvili's continuation;
for a dislocation at a hole Dundurs and Mura, 1964). Local axes: x into the material along the path, y along the
surface, the mouth at the origin; z = x + i y. The hole has its centre at -R, the straight edge is the limit R =
inf.

Stresses follow from the potentials by s_xx + s_yy = 4 Re Phi, s_yy - s_xx + 2 i s_xy = 2 (conj(z) Phi' + Psi),
displacements by 2 mu (u_x + i u_y) = kappa phi - z conj(Phi) - conj(psi), with Phi = phi', Psi = psi'.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from slmm.running.threaded import threaded

#: Burgers direction: a piece that opens, or one that slides
OPENING, SLIDING = 0, 1


@njit(cache=True, inline="always")
def _source(w, w0, alpha):
    """Potentials phi, Phi, Phi', Phi'' and psi, Psi, Psi' of a dipole at w0 in the unbounded plane."""
    beta = np.conj(alpha)
    d = 1.0 / (w - w0)
    d2 = d * d
    d3 = d2 * d
    phi, Phi, dPhi, ddPhi = -alpha * d, alpha * d2, -2.0 * alpha * d3, 6.0 * alpha * d3 * d
    both = alpha + beta
    psi = -both * d - alpha * w0 * d2
    Psi = both * d2 + 2.0 * alpha * w0 * d3
    dPsi = -2.0 * both * d3 - 6.0 * alpha * w0 * d3 * d
    return phi, Phi, dPhi, ddPhi, psi, Psi, dPsi


@njit(cache=True)
def _mirrored(w, w0, alpha, R):
    """What a free surface adds: phi, Phi, Phi', psi, Psi at w (from the hole's centre, or from the mouth)."""
    beta = np.conj(alpha)
    if np.isfinite(R):  # where the surface is conj(w) = s(w)
        s = R * R / w
        ds = -s / w
        dds = -2.0 * ds / w
        rest = beta / (w0 * w0)  # conj(Phi(0)): without it the far field would carry stress
    else:
        s = -w
        ds = complex(-1.0, 0.0)
        dds = complex(0.0, 0.0)
        rest = complex(0.0, 0.0)
    m_phi, m_Phi, m_dPhi, m_ddPhi, m_psi, m_Psi, m_dPsi = _source(s, w0, beta)
    phi = -w * m_Phi - m_psi
    Phi = -m_Phi - w * m_dPhi * ds - m_Psi * ds
    dPhi = -2.0 * m_dPhi * ds - w * (m_ddPhi * ds * ds + m_dPhi * dds) - m_dPsi * ds * ds - m_Psi * dds
    psi = -m_phi - s * Phi - 2.0 * rest.real * s
    Psi = -m_Phi * ds - ds * Phi - s * dPhi - 2.0 * rest.real * ds
    return phi + rest * w, Phi + rest, dPhi, psi, Psi


@njit(cache=True)
def _strength(direction, mu, kappa):
    strength = mu / (np.pi * (1.0 + kappa))
    return complex(strength, 0.0) if direction == OPENING else complex(0.0, -strength)


@njit(cache=True)
def _stress(w, Phi, dPhi, Psi):
    total = 4.0 * Phi.real
    difference = 2.0 * (np.conj(w) * dPhi + Psi)
    return 0.5 * (total - difference.real), 0.5 * (total + difference.real), 0.5 * difference.imag


@njit(cache=True)
def dipole_field(x, y, depth, direction, R, mu, kappa):
    """Stress xx, yy, xy and displacement x, y at a point, for a jump times length of 1 mm^2.

    Parameters
    ----------
    x, y : float
        The point in local axes, mm.
    depth : float
        Of the piece of crack below the surface, mm.
    direction : {OPENING, SLIDING}
        Jump along y or along x.
    R : float
        Radius of the hole, mm; inf for a straight edge.
    mu, kappa : float
        Shear modulus, MPa, and Kolosov's constant: (3 - nu)/(1 + nu) in plane stress.
    """
    shift = R if np.isfinite(R) else 0.0
    w, w0 = complex(x + shift, y), depth + shift
    alpha = _strength(direction, mu, kappa)
    phi, Phi, dPhi, _, psi, Psi, _ = _source(w, w0, alpha)
    m_phi, m_Phi, m_dPhi, m_psi, m_Psi = _mirrored(w, w0, alpha, R)
    phi, Phi, dPhi, psi, Psi = phi + m_phi, Phi + m_Phi, dPhi + m_dPhi, psi + m_psi, Psi + m_Psi
    xx, yy, xy = _stress(w, Phi, dPhi, Psi)
    u = (kappa * phi - w * np.conj(Phi) - np.conj(psi)) / (2.0 * mu)
    return xx, yy, xy, u.real, u.imag


@njit(cache=True)
def mirror_stress(at, depths, R, mu, kappa):
    """Stress on the path that the free surface adds to that of dipoles in the unbounded plane.

    Parameters
    ----------
    at, depths : ndarray (n,), (k,)
        Where on the path, and depths of the dipoles, mm.
    R, mu, kappa : float
        As in `dipole_field`.

    Returns
    -------
    ndarray (2, n, k)
        Stress across the path by dipoles that open, shear stress by those that slide, MPa/mm^2.
    """
    shift = R if np.isfinite(R) else 0.0
    result = np.empty((2, len(at), len(depths)))
    for direction in range(2):
        alpha = _strength(direction, mu, kappa)
        for i in range(len(at)):
            w = complex(at[i] + shift, 0.0)
            for j in range(len(depths)):
                _, Phi, dPhi, _, Psi = _mirrored(w, depths[j] + shift, alpha, R)
                _, yy, xy = _stress(w, Phi, dPhi, Psi)
                result[direction, i, j] = yy if direction == OPENING else xy
    return result


@threaded(cache=True)
def dipoles_on_boundary(points, normals, nodes, origin, along, depths, R, mu, kappa):
    """Tractions and displacements on a boundary of dipoles at some depths, first all that open, then all that slide.

    Parameters
    ----------
    points, normals : ndarray (q, 2)
        Integration points, mm, and outward normals times the length each point stands for.
    nodes : ndarray (b, 2)
        Points where the displacement is wanted, mm.
    origin, along : ndarray (2,)
        The path's mouth, mm, and its unit direction.
    depths : ndarray (k,)
        Of the dipoles, mm.
    R, mu, kappa : float
        As in `dipole_field`.

    Returns
    -------
    traction : ndarray (q, 2, 2 k)
        Force on each integration point's share of the boundary.
    u : ndarray (b, 2, 2 k)
        Displacements.
    """
    k = len(depths)
    tx, ty = along[0], along[1]
    traction = np.empty((len(points), 2, 2 * k))
    for i in prange(len(points)):
        dx, dy = points[i, 0] - origin[0], points[i, 1] - origin[1]
        x, y = dx * tx + dy * ty, dy * tx - dx * ty
        nx, ny = normals[i, 0] * tx + normals[i, 1] * ty, normals[i, 1] * tx - normals[i, 0] * ty
        for direction in range(2):
            for j in range(k):
                xx, yy, xy, _, _ = dipole_field(x, y, depths[j], direction, R, mu, kappa)
                fx, fy = xx * nx + xy * ny, xy * nx + yy * ny
                traction[i, 0, direction * k + j] = fx * tx - fy * ty
                traction[i, 1, direction * k + j] = fx * ty + fy * tx
    u = np.empty((len(nodes), 2, 2 * k))
    for i in prange(len(nodes)):
        dx, dy = nodes[i, 0] - origin[0], nodes[i, 1] - origin[1]
        x, y = dx * tx + dy * ty, dy * tx - dx * ty
        for direction in range(2):
            for j in range(k):
                _, _, _, ux, uy = dipole_field(x, y, depths[j], direction, R, mu, kappa)
                u[i, 0, direction * k + j] = ux * tx - uy * ty
                u[i, 1, direction * k + j] = ux * ty + uy * tx
    return traction, u
