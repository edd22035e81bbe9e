"""Crack tips: J, K and kinks on disks and plates against exact and published values (Paper B, section 3.2).

Paper B's disk has the field of K_I and K_II prescribed at its rim; it is meshed with rings of quadrilaterals, those at
the tip collapsed, or with triangles. Plates are body-fitted meshes of quadratic triangles. Kinks: the criteria on K_I
and K_II, and Frankl's correction on meshes with a kinked crack.

Required: J of mode I within 0.3 %, of mixed mode within 0.5 %, contours apart by 0.2 % at most, stress intensities
within 0.5 %, kink angles within 0.5 degrees; where a stress parallel to the crack acts, J across it within 1 % of J
along it. Writes validation/results/crack_tips.csv and crack_tips.png, 20 seconds; ``--quick`` one case of each kind.
"""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from checks import RESULTS, Check, run, save, show
from elastic_model import solved

from slmm.fem.mesh import plate_mesh
from slmm.fem.plate_model import PlateModel
from slmm.fracture.configurational_forces import forces_in_rings, forces_within, nodal_configurational_forces
from slmm.fracture.kink_correction import CorrectedKink, corrected_kink
from slmm.fracture.kinking import kinked_stress_intensities, local_symmetry, maximum_energy_release_rate
from slmm.fracture.loading import crack_tip_loading
from slmm.fracture.tip_field import tip_displacement
from slmm.mechanics.elasticity import Elasticity
from slmm.mechanics.element_results import ElementResults, linear_elastic
from slmm.mechanics.material import Material
from slmm.part.outline import Outline
from slmm.part.part import Part
from slmm.part.shapes import circle
from slmm.scene.loading import plate_loading

matplotlib.use("Agg")
import matplotlib.pyplot as plt

STEEL = Elasticity(210e3, 0.3, "plane strain")
PMMA = Material.from_name("PMMA")
#: MPa sqrt(mm) of 1 MPa sqrt(m)
ROOT_M = np.sqrt(1000.0)
#: elements of the disk, and how many of them around its tip
DISKS = {"CPE3": 96, "CPE4": 96, "CPE4R": 96, "CPE6": 24, "CPE8": 24, "CPE8R": 24}
#: K_II/K_I, angle of the largest release rate, that rate over the one straight on, angle of local symmetry
AMESTOY_LEBLOND = [
    (0.25, -25.86, 1.1109, -25.87),
    (0.5, -42.03, 1.3343, -42.13),
    (1.0, -56.57, 1.6680, -56.96),
]


def disk(
    element_type: str, sectors: int, radius: float = 50.0, tip_size: float = 0.05
) -> tuple[np.ndarray, dict[str, np.ndarray], np.ndarray]:
    """Nodes, cells and the rim's nodes of a disk with a slit along its negative x axis.

    Rings of elements, each wider than the one inside; quadrilaterals at the tip are collapsed as in Fig. 3.8 of the
    thesis, their midside nodes left in the middle. Triangles are quadrilaterals cut in two.
    """
    triangles, quadratic = element_type in ("CPE3", "CPE6"), element_type[3] in "68"
    step = 2 if quadratic else 1  # of the grid of nodes from corner to corner
    rings = int(np.ceil(np.log(radius / tip_size) / np.log1p(2 * np.pi / sectors)))
    corner = np.concatenate(
        [[0.0], radius * (1 + 2 * np.pi / sectors) ** -np.arange(rings, dtype=float)[::-1]]
    )
    r = np.interp(np.arange(step * rings + 1) / step, np.arange(rings + 1), corner)
    theta = np.linspace(-np.pi, np.pi, step * sectors + 1)
    grid = r[:, None, None] * np.stack([np.cos(theta), np.sin(theta)], axis=-1)
    grid[np.abs(grid) < 1e-12 * radius] = 0.0  # both faces lie on the axis exactly
    if quadratic:
        grid[:, 1::2] = (grid[:, :-1:2] + grid[:, 2::2]) / 2
    number = np.arange(grid[..., 0].size).reshape(grid.shape[:2])
    number[0] = 0
    i, j = (x.ravel() for x in np.meshgrid(step * np.arange(rings), step * np.arange(sectors), indexing="ij"))
    corners = {0: (0, 0), 1: (step, 0), 2: (step, step), 3: (0, step)}

    def cells(order: tuple[int, ...], of: np.ndarray) -> np.ndarray:
        place = [corners[k] for k in order]
        if quadratic:
            place += [tuple(np.add(place[k - 1], place[k]) // 2) for k in (*range(1, len(order)), 0)]
        return np.stack([number[i[of] + a, j[of] + b] for a, b in place], axis=1)

    everywhere = np.ones(len(i), dtype=bool)
    if triangles:
        nodes = np.concatenate([cells((0, 1, 2), everywhere), cells((0, 2, 3), i > 0)])
    else:
        nodes = cells((0, 1, 2, 3), everywhere)
    return grid.reshape(-1, 2), {element_type: nodes}, number[-1]


def disk_results(element_type: str, K: tuple[float, float], **mesh: Any) -> ElementResults:
    """The disk under K_I and K_II, MPa sqrt(m)."""
    points, cells, rim = disk(element_type, **{"sectors": DISKS[element_type], **mesh})
    prescribed, values = np.zeros(points.shape, dtype=bool), np.zeros_like(points)
    prescribed[rim] = True
    at = points[rim].copy()
    at[0, 1] = -0.0  # the lower face's end
    values[rim] = tip_displacement(at, ROOT_M * np.array(K), STEEL)
    return solved(points, cells, STEEL, prescribed, values)


def pressed(results: ElementResults, pressure: float) -> ElementResults:
    """The results less a uniform tension across the crack, which leaves this pressure, MPa, on its faces: K stays."""
    nu = STEEL.nu
    strain = pressure / STEEL.E * np.array([-nu * (1 + nu), 1 - nu**2])
    return linear_elastic(results.points, results.cells, results.u - results.points * strain, STEEL)


def loaded_faces(quick: bool) -> list[Check]:
    """Half as much pressure again on the faces as the tension that the tip causes ahead of it at the disk's rim."""
    checks = []
    exact, K = 1e6 * 400 / STEEL.E_prime, 20.0
    pressure = 1.5 * K * ROOT_M / np.sqrt(2 * np.pi * 50.0)
    for name in ("CPE4", "CPE8") if quick else DISKS:
        tip = crack_tip_loading(pressed(disk_results(name, (K, 0.0)), pressure)).isel(tip=0)
        case = f"disk, mode I, faces under {pressure:.0f} MPa, {name}"
        checks.append(Check(case, "J_x, J/m2", exact, 1e3 * float(tip.G), 3e-3, source="superposition"))
        K_I = float(tip.K_I) / ROOT_M
        checks.append(Check(case, "K_I, MPa sqrt(m)", K, K_I, 5e-3, source="superposition"))
        text = "contours apart, over J"
        checks.append(Check(case, text, 2e-3, float(tip.spread), rule="at most", source="path independence"))
    return checks


def disks(quick: bool) -> list[Check]:
    checks = []
    source = "exact; the published tool: 1738.3, (-2155, 1697)"
    for name in ("CPE4", "CPE8") if quick else DISKS:
        for K, what in (((20.0, 0.0), "mode I"), ((20.0, 10.0), "mixed mode")):
            results = disk_results(name, K)
            (tip,) = (loading.isel(tip=0) for loading in [crack_tip_loading(results)])
            case = f"disk, {what}, {name}"
            J = 1e3 * np.array([float(tip.G), float(tip.J_across)])
            exact = 1e6 * np.array([K[0] ** 2 + K[1] ** 2, -2 * K[0] * K[1]]) / STEEL.E_prime
            tolerance = 3e-3 if K[1] == 0 else 5e-3
            checks.append(Check(case, "J_x, J/m2", exact[0], J[0], tolerance, source=source))
            if K[1]:
                checks.append(Check(case, "J_y, J/m2", exact[1], J[1], tolerance, source=source))
                checks.append(
                    Check(case, "K_II, MPa sqrt(m)", K[1], float(tip.K_II) / ROOT_M, 5e-3, source="exact")
                )
            checks.append(
                Check(case, "K_I, MPa sqrt(m)", K[0], float(tip.K_I) / ROOT_M, 5e-3, source="exact")
            )
            apart = (np.ptp([tip.J_x.values, tip.J_y.values], axis=1) / np.hypot(*J) * 1e3).max()
            text = "contours apart, over |J|"
            checks.append(Check(case, text, 2e-3, apart, rule="at most", source="path independence"))
            if name == "CPE8" and K[1] == 0:
                forces = nodal_configurational_forces(
                    results.points, results.cells, results.u, results.stress, results.energy, "linear"
                )
                plain = -1e3 * forces_within(results.points, forces, [0, 0], [25.0])[0, 0]
                checks.append(Check(case, "plain sum of forces, J/m2", exact[0], plain, 3e-3, source="exact"))
    return checks


def solid_disk(sectors: int = 24, thickness: float = 2.0) -> list[Check]:
    """One layer of C3D20 between planes that do not move: its nodes' forces around the front, summed in rings."""
    plane, cells, rim = disk("CPE8", sectors)
    nodes, n = cells["CPE8"], len(plane)
    corners = np.unique(nodes[:, :4])
    upright = np.full(n, -1)
    upright[corners] = 2 * n + np.arange(len(corners))
    points = np.concatenate([np.pad(plane, ((0, 0), (0, 1)), constant_values=z) for z in (0.0, thickness)])
    points = np.concatenate([points, np.pad(plane[corners], ((0, 0), (0, 1)), constant_values=thickness / 2)])
    solid = np.hstack([nodes[:, :4], nodes[:, :4] + n, nodes[:, 4:], nodes[:, 4:] + n, upright[nodes[:, :4]]])
    rims = np.concatenate([rim, rim + n, upright[rim[upright[rim] >= 0]]])
    at = points[rims, :2].copy()
    at[np.isin(rims, [rim[0], rim[0] + n, upright[rim[0]]]), 1] = -0.0  # the lower face's end
    prescribed, values = np.zeros(points.shape, dtype=bool), np.zeros_like(points)
    prescribed[:, 2] = True
    prescribed[rims] = True
    values[rims, :2] = tip_displacement(at, ROOT_M * np.array([20.0, 0.0]), STEEL)
    results = solved(points, {"C3D20": solid}, STEEL, prescribed, values)
    forces = nodal_configurational_forces(
        results.points, results.cells, results.u, results.stress, results.energy, "linear"
    )
    J = -1e3 * forces_in_rings(results.cells, forces, [0, n, upright[0]], 12)[:, 0] / thickness
    exact = 1e6 * 400 / STEEL.E_prime
    checks = [
        Check("disk, mode I, C3D20", f"ring {k}, J/m2", exact, J[k - 1], 3e-3, source="exact")
        for k in (4, 8, 12)
    ]
    return checks


def plate(
    width: float, height: float, crack: np.ndarray, outlines: tuple[Outline, ...] = (), **load: Any
) -> ElementResults:
    """A plate of PMMA with one crack (n, 2) or more (k, n, 2), under uniform tension 1 MPa or as ``load`` says."""
    part = Part.plate(width, height, outlines, crack if crack.ndim == 3 else [crack])
    loading = plate_loading(width, height, **(load or {"stress": 1.0}))
    return PlateModel(plate_mesh(part), PMMA, loading).results


def compared(case: str, tip: xr.Dataset, unit: float, wanted: tuple[float, ...], source: str) -> list[Check]:
    """K over a unit, and J against K."""
    K = np.array([float(tip.K_I), float(tip.K_II)])
    checks = [
        Check(case, f"{name}, normalised", value, ours, 5e-3, source=source)
        for name, value, ours in zip(("K_I", "K_II"), wanted, K / unit, strict=False)
    ]
    E = PMMA.plane_stress_equivalent[0]
    checks.append(
        Check(case, "E G over K_I^2 + K_II^2", 1.0, E * float(tip.G) / (K @ K), 5e-3, source="Irwin")
    )
    if len(wanted) > 1:
        off = abs(E * float(tip.J_across) + 2 * K[0] * K[1]) / (K @ K)
        checks.append(
            Check(case, "error of J_y over J_x", 0.01, off, rule="at most", source="-2 K_I K_II/E'")
        )
    return checks


def plates(quick: bool) -> list[Check]:
    checks = []
    W = 100.0
    edge = {0.1: 1.1892, 0.2: 1.3673, 0.3: 1.6599, 0.4: 2.1114, 0.5: 2.8246}
    for ratio in [0.3] if quick else edge:
        a = ratio * W
        tip = crack_tip_loading(plate(W, 6 * W, np.array([[0, 3 * W], [a, 3 * W]]))).isel(tip=0)
        checks += compared(
            f"edge crack, a/W = {ratio}", tip, np.sqrt(np.pi * a), (edge[ratio],), "p-version FE, 1e-4"
        )
    tip = crack_tip_loading(plate(100.0, 250.0, np.array([[0, 125.0], [37.5, 125.0]]))).isel(tip=0)
    checks += compared("Code_Aster SSLP101", tip, 1.0, (21.44,), "Tada, 0.5 %")[:1]
    centre = {0.1: 1.0060, 0.3: 1.0577, 0.5: 1.1867, 0.7: 1.4883}
    for ratio in [0.5] if quick else centre:
        a, c = ratio * W / 2, np.array([W / 2, 1.5 * W])
        tips = crack_tip_loading(plate(W, 3 * W, c + np.array([[-a, 0], [a, 0]])))
        for k in range(2):
            case = f"centre crack, 2a/W = {ratio}, {'left' if tips.x[k] < W / 2 else 'right'} tip"
            checks += compared(case, tips.isel(tip=k), np.sqrt(np.pi * a), (centre[ratio],), "Isida, 1e-3")
    for angle in [37.0] if quick else [20.0, 37.0, 60.0]:
        a, W = 10.0, 800.0
        d = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
        tips = crack_tip_loading(plate(W, W, np.array([W / 2 - a * d, W / 2 + a * d])))
        wanted = d[0] ** 2, d[0] * d[1]
        case = f"inclined crack, {angle:g} degrees"
        checks += compared(case, tips.isel(tip=0), np.sqrt(np.pi * a), wanted, "exact")
    return checks + cracks_at_a_hole(quick)


def cracks_at_a_hole(quick: bool) -> list[Check]:
    R, W = 10.0, 3000.0
    hole = (Outline.through(circle((W / 2, W / 2), R)),)
    checks = []
    one = {0.1: 2.7727, 0.2: 2.3746, 0.5: 1.7279, 1.0: 1.3061, 2.0: 1.0307}
    for ratio in [0.5] if quick else one:
        L = ratio * R
        crack = W / 2 + np.array([[0.9 * R, 0], [R + L, 0]])
        tip = crack_tip_loading(plate(W, W, crack, hole)).isel(tip=0)
        case = f"one crack at a hole, L/R = {ratio}"
        checks += compared(case, tip, np.sqrt(np.pi * L), (one[ratio],), "p-version FE, 1e-4")
    two = {0.1: 2.786, 0.5: 1.8329, 1.0: 1.4721, 2.0: 1.2445}
    for ratio in [0.5] if quick else two:
        L = ratio * R
        right, left = (W / 2 + side * np.array([[0.9 * R, 0], [R + L, 0]]) for side in (1, -1))
        tips = crack_tip_loading(plate(W, W, np.array([right, left]), hole))
        for k in range(2):
            case = f"two cracks at a hole, L/R = {ratio}, {'left' if tips.x[k] < W / 2 else 'right'} tip"
            checks += compared(case, tips.isel(tip=k), np.sqrt(np.pi * L), (two[ratio],), "Newman 1971")
    return checks


def kinks(quick: bool) -> list[Check]:
    """The criteria, and the corrected kink of a crack at 45 degrees: there no stress T disturbs."""
    checks = []
    source = "Amestoy and Leblond 1992"
    for ratio, angle, gain, symmetric in AMESTOY_LEBLOND:
        case = f"kink, K_II/K_I = {ratio}"
        merr = maximum_energy_release_rate(1.0, ratio)
        k = np.array(kinked_stress_intensities(1.0, ratio, merr))
        ours = k @ k / (1 + ratio**2)
        checks.append(_degrees(case, "largest release rate", angle, merr, source))
        checks.append(Check(case, "release rate over that straight on", gain, ours, 1e-3, source=source))
        checks.append(_degrees(case, "local symmetry", symmetric, local_symmetry(1.0, ratio), source))
        if quick and ratio != 0.5:
            continue
        straight, corrected = kinked_plate(ratio)
        merr, as_it_is, *_ = np.radians(straight.kink.values)
        checks.append(_degrees(case, "largest release rate, K of the plate", angle, merr, source))
        checks.append(_degrees(case, "corrected kink", angle, corrected.angle, source))
        rate = corrected.energy_release_rate / float(straight.G)
        checks.append(Check(case, "its release rate over that straight on", gain, rate, 1e-2, source=source))
        told = f"direction of J, uncorrected ({len(corrected.angles)} models corrected it)"
        checks.append(Check(case, told, angle, np.degrees(as_it_is), rule="told", source=source))
    return checks


def _degrees(case: str, quantity: str, wanted: float, angle: float, source: str) -> Check:
    """An angle within half a degree."""
    return Check(case, f"{quantity}, degrees", wanted, np.degrees(angle), 0.5 / abs(wanted), source=source)


def kinked_plate(ratio: float, width: float = 400.0, a: float = 10.0) -> tuple[xr.Dataset, CorrectedKink]:
    """The upper tip of a crack at 45 degrees under two stresses that make K_II/K_I: straight, and with its kink."""
    lateral = (1 - ratio) / (1 + ratio)
    E, nu = PMMA.plane_stress_equivalent
    strain = ((lateral - nu) / E, (1 - nu * lateral) / E, 0.0)
    half = a * np.array([1.0, 1.0]) / np.sqrt(2)
    crack = np.array([width / 2 - half, width / 2 + half])

    def solve(points: np.ndarray) -> ElementResults:
        return plate(width, width, points, strain=strain)

    tips = crack_tip_loading(solve(crack))
    straight = tips.isel(tip=int(np.argmax(tips.x.values)))
    start = float(np.radians(straight.kink.sel(criterion="J")))
    return straight, corrected_kink(solve, crack, 0.01 * a, start=start)


def draw(checks: list[Check]) -> None:
    """J of the published tool and ours over the exact values, and the errors of K."""
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.2), layout="constrained")
    published = {"J_x": -2155.0, "J_y": 1697.0}
    for k, component in enumerate(("J_x", "J_y")):
        found = [c for c in checks if "mixed" in c.case and c.quantity.startswith(component)]
        names = [c.case.split(", ")[-1] for c in found] + ["published"]
        values = [c.difference for c in found] + [abs(published[component] / found[0].wanted) - 1]
        axes[0].plot(names, 100 * np.array(values), "os"[k], label=component.replace("_", "$_") + "$")
    axes[0].axhspan(-0.5, 0.5, color="0.92", zorder=0)
    axes[0].set(ylabel="error of J, mixed mode, %")
    found = [c for c in checks if c.quantity.startswith(("K_I,", "K_II,")) and "disk" not in c.case]
    axes[1].plot([100 * c.difference for c in found], range(len(found)), "o", ms=4)
    axes[1].set_yticks(
        range(len(found)), [f"{c.case}: {c.quantity.split(',')[0]}" for c in found], fontsize=7
    )
    axes[1].axvspan(-0.5, 0.5, color="0.92", zorder=0)
    axes[1].set(xlabel="error of K, %")
    axes[0].legend(frameon=False)
    figure.savefig(RESULTS / "crack_tips.png", dpi=130)
    plt.close(figure)


def main(quick: bool = False) -> list[Check]:
    checks = disks(quick) + loaded_faces(quick) + solid_disk() + plates(quick) + kinks(quick)
    show("Crack tips against exact and published values", checks)
    if not quick:
        save("crack_tips", [check.row() for check in checks])
        draw(checks)
    return checks


if __name__ == "__main__":
    run(main, __doc__)
