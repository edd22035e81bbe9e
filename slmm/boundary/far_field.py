"""Sums over all panels by the plain Gauss rule: near ones point by point, far ones by Laurent series of clusters.

With a density h = g + q and d = conj(kappa q - g), the kernels of `slmm.boundary.influence` add up to

    2 pi i w = kappa Phi + conj(Psi + conj(z) Phi'),  Phi = sum h dtau/(tau - z),
    Psi = sum (d dtau + h conj(dtau))/(tau - z) - sum h conj(tau) dtau/(tau - z)^2

so that Phi and Psi of a cluster of points are one Laurent series each (Greengard and Rokhlin, J. Comput. Phys. 73
(1987) 325-348; here without their local series).
"""

from __future__ import annotations

import numpy as np
from numba import prange

from slmm.boundary.rules import Array, Complex
from slmm.running.threaded import threaded

#: points in the smallest clusters (chosen by the time), how large a cluster may be over its distance, and the terms of
#: its series: what they leave out is 0.5^30
LEAF, OPENING, TERMS = 48, 0.5, 30


class Clusters:
    """Points in the plane, halved and halved again, and for each of the smallest clusters what is near and what is far.

    Parameters
    ----------
    z, dz : ndarray, shape (n,)
        Points and their integration weights along the boundary, mm.

    Examples
    --------
    >>> z = np.exp(2j * np.pi * np.arange(400) / 400)
    >>> dz = 2j * np.pi / 400 * z
    >>> inside = Clusters(z, dz).displacement(np.ones(400), np.zeros(400), kappa=2.0) / (2j * np.pi)
    >>> bool(np.abs(inside - 1.0).max() < 1e-2)
    True
    """

    def __init__(self, z: Complex, dz: Complex) -> None:
        """Build the tree and its lists."""
        order = np.arange(len(z))
        begin, stop, child = [0], [len(z)], [-1]
        k = 0
        while k < len(begin):
            of = order[begin[k] : stop[k]]
            if len(of) > LEAF:
                x = z[of]
                wide = np.ptp(x.real) >= np.ptp(x.imag)
                half = len(of) // 2
                order[begin[k] : stop[k]] = of[np.argpartition(x.real if wide else x.imag, half)]
                child[k] = len(begin)
                begin += [begin[k], begin[k] + half]
                stop += [begin[k] + half, stop[k]]
                child += [-1, -1]
            k += 1
        self.order, self._z, self._dz = order, z[order], dz[order]
        self._begin, self._stop, self._child = np.array(begin), np.array(stop), np.array(child)
        boxes = [self._z[a:b] for a, b in zip(begin, stop, strict=True)]
        self._centre = np.array(
            [0.5 * complex(x.real.min() + x.real.max(), x.imag.min() + x.imag.max()) for x in boxes]
        )
        self._radius = np.array([np.abs(x - c).max() for x, c in zip(boxes, self._centre, strict=True)])
        self._leaves = np.flatnonzero(self._child < 0)
        self._near, self._far = self._lists()

    def _lists(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """For each leaf the leaves that are near, and the clusters that are far: first places, and numbers."""
        near: list[list[int]] = []
        far: list[list[int]] = []
        for leaf in self._leaves:
            near.append([])
            far.append([])
            todo = np.array([0])
            while len(todo):
                away = np.abs(self._centre[todo] - self._centre[leaf]) - self._radius[leaf]
                is_far = self._radius[todo] < OPENING * away
                is_leaf = ~is_far & (self._child[todo] < 0)
                far[-1] += todo[is_far].tolist()
                near[-1] += todo[is_leaf].tolist()
                first = self._child[todo[~is_far & ~is_leaf]]
                todo = np.concatenate([first, first + 1])
        return _packed(near), _packed(far)

    def displacement(self, h: Complex, d: Complex, kappa: float) -> Complex:
        """2 pi i w (n,) at the points themselves by densities h and d (n,), without that of each point on itself."""
        h, d = np.asarray(h, dtype=complex)[self.order], np.asarray(d, dtype=complex)[self.order]
        a, b = h * self._dz, d * self._dz + h * self._dz.conj()
        phi, psi = _series(self._z, a, b, self._begin, self._stop, self._centre, self._radius)
        result = np.empty(len(h), dtype=complex)
        result[self.order] = _summed(
            self._z,
            a,
            b,
            self._begin,
            self._stop,
            self._centre,
            self._radius,
            self._leaves,
            *self._near,
            *self._far,
            phi,
            psi,
            kappa,
        )
        return result


def _packed(lists: list[list[int]]) -> tuple[Array, Array]:
    first = np.cumsum([0, *(len(each) for each in lists)])
    return first, np.array([number for each in lists for number in each], dtype=np.int64)


@threaded(cache=True, error_model="numpy")
def _series(z, a, b, begin, stop, centre, radius):
    """Coefficients (clusters, TERMS) of the series of Phi and Psi about the centres, in distances over the radii."""
    m = len(begin)
    phi = np.zeros((m, TERMS), dtype=np.complex128)
    psi = np.zeros((m, TERMS), dtype=np.complex128)
    for k in prange(m):
        scale = 1.0 / max(radius[k], 1e-300)
        for j in range(begin[k], stop[k]):
            t = (z[j] - centre[k]) * scale
            back = t.conjugate() * a[j]
            power, before = 1.0 + 0.0j, 0.0j
            for n in range(TERMS):
                phi[k, n] += a[j] * power
                psi[k, n] += b[j] * power + n * back * before
                before = power
                power *= t
    return phi, psi


@threaded(cache=True, error_model="numpy")
def _summed(z, a, b, begin, stop, centre, radius, leaves, near_first, near, far_first, far, phi, psi, kappa):
    """2 pi i w (n,) at the points, leaf by leaf."""
    result = np.zeros(len(z), dtype=np.complex128)
    for l in prange(len(leaves)):
        leaf = leaves[l]
        for i in range(begin[leaf], stop[leaf]):
            one, other = 0.0j, 0.0j
            for k in near[near_first[l] : near_first[l + 1]]:
                for j in range(begin[k], stop[k]):
                    if j != i:
                        x, y = z[j].real - z[i].real, z[j].imag - z[i].imag
                        r = 1.0 / (x * x + y * y)
                        u = complex(x * r, -y * r)
                        step = a[j] * u
                        one += step
                        other += b[j] * u - complex(x, -y) * step * u
            for k in far[far_first[l] : far_first[l + 1]]:
                gap = z[i] - centre[k]
                u = radius[k] / gap
                first, slope, second = 0.0j, 0.0j, 0.0j
                for n in range(TERMS - 1, -1, -1):
                    first = first * u + phi[k, n]
                    slope = slope * u + (n + 1) * phi[k, n]
                    second = second * u + psi[k, n]
                over = 1.0 / gap
                one -= first * over
                other += (gap.conjugate() * slope * over - second) * over
            result[i] = kappa * one + other.conjugate()
    return result
