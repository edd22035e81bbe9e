"""CPU time of a sweep of crack cells, beside that of a factorisation for each crack length."""

from __future__ import annotations

import resource
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy.sparse.linalg as spla

from precompute.crack_cell import cell_body, solve_cell
from precompute.spec import SweepSpec
from precompute.sweep import run_sweep

Row = dict[str, float | str]


def cpu(work: Callable[[], object]) -> float:
    begin = time.process_time()
    work()
    return time.process_time() - begin


def naive_cell(curvature: float, nu: float, spec: SweepSpec, lengths: np.ndarray, way: str) -> float:
    """CPU seconds of one factorisation for each crack length and symmetry, on the same mesh.

    ``way`` is "ordered" (assembled once, the ordering that suits best), "jobs" (the same, but meshed and
    assembled anew for every crack length, as a job for each does) or "plain" (as "jobs" with the default
    ordering of scipy).
    """
    total = 0.0
    stored = np.array(spec.crack_length)
    body = cell_body(curvature, stored, spec.fineness)
    K = body.stiffness(nu)
    for a in lengths:
        if way != "ordered":
            begin = time.process_time()
            body = cell_body(curvature, stored, spec.fineness)
            K = body.stiffness(nu)
            total += time.process_time() - begin
        for d in (0, 1):
            begin = time.process_time()
            held = body.held.copy()
            line = np.flatnonzero(body.free)[body.line[d]]
            held[line[body.line_eta >= a * (1 - 1e-9)]] = True
            modes = [mode for mode in spec.mode_list if mode.symmetric == (d == 0)]
            u = np.stack(
                [body.held * (body.direction == mode.direction) * mode(*body.where) for mode in modes], axis=1
            )
            free = ~held
            K_free = K[free][:, free].tocsc()
            if way == "plain":
                lu = spla.splu(K_free)
            else:
                lu = spla.splu(
                    K_free,
                    permc_spec="MMD_AT_PLUS_A",
                    diag_pivot_thresh=0.0,
                    options={"SymmetricMode": True},
                )
            u[free] = -lu.solve((K @ u)[free])
            u.T @ (K @ u)
            total += time.process_time() - begin
    return total


def speed_study(quick: bool) -> list[Row]:
    """The sweep of one material: 16 curvatures, the published 16 modes, 10 lengths."""
    lengths = tuple(np.geomspace(0.02, 1.0, 10).round(6).tolist())
    spec = SweepSpec(poisson=(0.3,), modes="published", crack_length=lengths)
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        begin = time.perf_counter()
        run_sweep(spec, Path(folder), workers=2)
        wall = time.perf_counter() - begin
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    rows: list[Row] = [
        {"what": "whole sweep on 2 processes, with the unbounded bodies: wall", "seconds": wall},
        {"what": "whole sweep: CPU", "seconds": used},
    ]
    some = spec.curvature[::5] if quick else spec.curvature
    scale = len(spec.curvature) / len(some)
    arguments = (np.array(lengths), spec.eta, spec.mode_list, spec.fineness)
    solve_cell(0.0, 0.3, *arguments)  # first call loads libraries
    ours = scale * sum(cpu(lambda c=c: solve_cell(c, 0.3, *arguments)) for c in some)
    rows.append({"what": "all crack cells, every length from one factor: CPU", "seconds": ours})
    tried = np.array(lengths[4:5] if quick else lengths[::3])
    every = (1 + len(lengths)) / len(tried)  # and the cell without a crack
    for way, label in (
        ("ordered", "a factorisation per length and symmetry, assembled once, best ordering: CPU"),
        ("jobs", "a factorisation per length and symmetry, a model for each length: CPU"),
        ("plain", "the same with scipy's default ordering: CPU"),
    ):
        naive = len(spec.curvature) * every * np.mean([naive_cell(c, 0.3, spec, tried, way) for c in (-0.5,)])
        rows.append({"what": label, "seconds": float(naive), "ratio": float(naive / ours)})
    return rows
