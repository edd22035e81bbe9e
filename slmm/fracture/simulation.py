"""The fracture process of a part: cracks start, grow, are arrested and start anew until it is severed (Paper D)."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import nullcontext
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from slmm.fracture.boundary_engine import BoundaryEngine
from slmm.fracture.directions import direction_of
from slmm.fracture.engine import Engine, Rules
from slmm.fracture.fem_engine import FemEngine
from slmm.fracture.first_cracks import INITIATIONS
from slmm.fracture.fracture_result import fracture_result
from slmm.fracture.growth import LOOK_AHEAD
from slmm.fracture.journal import run_of
from slmm.fracture.lengths import lengths_of
from slmm.fracture.process import Process
from slmm.mechanics.material import Material
from slmm.running.blas import one_blas_thread
from slmm.running.line_journal import open_lines
from slmm.running.progress import Progress, silent
from slmm.scene.loading import Loading
from slmm.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

ENGINES: dict[str, Callable[[Material, Loading, float], Engine]] = {
    "boundary": BoundaryEngine,
    "fem": FemEngine,
}


def simulate(
    scene: Scene,
    increment: float | str = "auto",
    initiation: str = "point",
    engine: str = "boundary",
    tolerance: float = 0.01,
    *,
    direction: str = "MTS",
    critical_distance: float | None = None,
    first_length: float | None = None,
    largest_displacement: float | None = None,
    at_least: float = 0.0,
    errors: bool = True,
    journal: str | Path | None = None,
    resume: bool = False,
    from_step: int | None = None,
    progress: Progress = silent,
) -> xr.Dataset:
    """Fracture of a part under a load that grows until it breaks: cracks, the curve F(u), and the tensile toughness.

    One event after the other: the tip or the free surface with the lowest critical load. Tips grow where G reaches G_c,
    in the direction that a criterion finds; cracks start where a criterion of initiation is met first: by the point
    method where the principal stress at a distance below a surface reaches the strength. Cracks end on what they run
    into, and are arrested there. The force drops at constant displacement, and the displacement never falls (Paper D,
    section 2.2.3).

    Parameters
    ----------
    scene : Scene
        Its load counts as a unit.
    increment : float or "auto"
        Length of an increment, mm; "auto" begins with 1/40 of the part's shorter side, becomes shorter where the path
        bends, and longer where it is straight, far from surfaces, and the curve falls. Its increments lead half of the
        next turn of a smooth path ahead, see `slmm.fracture.bends`; those of a given length follow the criterion's
        direction where they begin, as published.
    initiation : {"point", "coupled", "slmm+ac"}
        What starts cracks at surfaces: the point method, the coupled criterion by trial cracks, or the same by crack
        cells of the database where one fits, in plates under [load]. The last two know how long the crack is then.
    engine : {"boundary", "fem"}
        What solves the part: boundary integrals, or finite elements on a mesh of their own for every increment, which
        take some ten times as long. Faces of cracks that would overlap hold each other in both, without friction.
    tolerance : float
        Relative error of U_T that the engine's own model aims at.
    direction : {"MTS", "MERR", "local symmetry", "J", "GMTS"}
        Which way cracks grow: largest tangential stress, largest energy release rate, no mode II, along the vector J,
        or the largest tangential stress at a distance from the tip, where the stress T along the crack counts, too. At
        which load they grow is Griffith's criterion in any case.
    critical_distance : float, optional
        That distance r_c of "GMTS", mm; the material's (K_Ic/sigma_c)^2/(2 pi) if not given.
    first_length : float, optional
        Of a crack that starts, mm, where its criterion does not say it; an increment if not given.
    largest_displacement : float, optional
        Where to stop, mm.
    at_least : float
        U_T that is asked for, mJ: a simulation ends as soon as it can no longer reach that before the largest
        displacement, see `slmm.fracture.history.History.toughness_at_most`, and its U_T is what it was until then.
    errors : bool
        Whether U_T has an estimated error, for some of the time of the simulation.
    journal : str or Path, optional
        A file to which each step is written as soon as it is done, see `slmm.fracture.journal`.
    resume : bool
        Go on behind the last step of the journal, if it is there; the result is that of a simulation that was never
        stopped, to the bit.
    from_step : int, optional
        Resume behind so many steps of the journal, 0 to all of them, and drop those that follow: behind another than
        the last one, or where a simulation has ended.
    progress : callable

    Returns
    -------
    Dataset
        Over ``corner``: ``u`` (mm) and ``F`` (N), corner points of the curve; over ``step``: ``u_c``, ``u_load``,
        ``stiffness`` before the step, ``event``, ``tip`` (of which crack), ``x``, ``y`` where it stands after it,
        ``arrested_by``, ``K_I``, ``K_II``, ``released``, ``dissipated``, ``gap``, ``closed`` (length of cracks whose
        faces hold each other, mm) and more; over ``candidate`` what was in question in each step; over ``state`` the
        equilibrium path; ``U_T``, ``U_T_error`` in mJ, and ``U_T_integrated``, in which the force falls steadily where
        cracks grow so; crack paths over ``crack`` and ``point``; ``outcome`` among the attributes.

    Raises
    ------
    ValueError
        When an argument or the load does not fit, or the journal is that of another simulation, damaged, or of one that
        has not ended and is not resumed. What fails later ends the simulation with its reason and the steps so far.
    NotWrittenError
        When the journal cannot be written; it is resumed with the steps that it holds.
    ImportError
        When the engine needs an extra that is not installed.

    Examples
    --------
    >>> from slmm.scene.gallery import tensile_plate
    >>> result = simulate(tensile_plate(), increment=4.0)
    >>> round(float(result.U_T)), result.attrs["outcome"]
    (107, 'the part is severed')
    """
    if initiation not in INITIATIONS:
        raise ValueError(f"initiation = {initiation!r}: must be one of {', '.join(INITIATIONS)}")
    if engine not in ENGINES:
        raise ValueError(f"engine = {engine!r}: must be one of {', '.join(ENGINES)}")
    if engine == "fem" and initiation != "point":
        raise ValueError(
            f"initiation = {initiation!r}: engine fem knows 'point' alone; take the engine 'boundary' for it"
        )
    way = direction_of(direction, scene.material, critical_distance)
    for name, value in (("tolerance", tolerance), ("largest_displacement", largest_displacement)):
        if value is not None and not (math.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value!r}: must be a positive number")
    if not (math.isfinite(at_least) and at_least >= 0):
        raise ValueError(f"at_least = {at_least!r}: must be a toughness, mJ, or 0")
    if at_least and largest_displacement is None:
        raise ValueError(
            f"at_least = {at_least!r}: needs a largest displacement, up to which it is reached or not"
        )
    if resume and journal is None:
        raise ValueError("resume = True: needs the journal of what shall be resumed")
    if from_step is not None and not resume:
        raise ValueError(f"from_step = {from_step!r}: needs resume = True, which it is for")
    if from_step is not None and (not isinstance(from_step, Integral) or from_step < 0):
        raise ValueError(f"from_step = {from_step!r}: must be a number of steps, 0 or more")
    lengths = lengths_of(scene.part, increment, first_length, LOOK_AHEAD)
    solver = ENGINES[engine](scene.material, scene.loading, tolerance)
    settings = {
        "increment": "auto" if lengths.by_path else lengths.growth,
        "first_length": lengths.first,
        "look_ahead": lengths.ahead,
        "initiation": initiation,
        "direction": direction,
        **({"critical_distance": way.distance} if way.asks_for_T else {}),
        "engine": engine,
        "tolerance": tolerance,
    }
    largest = largest_displacement or math.inf
    rules = Rules(way, INITIATIONS[initiation](scene))
    process = Process(scene, solver, rules, lengths, largest, errors, at_least)
    asked = {"at_least": at_least} if at_least else {}
    run = run_of(scene, {**settings, "largest_displacement": largest_displacement, **asked, "errors": errors})
    with (
        nullcontext() if journal is None else open_lines(journal, run, resume, from_step) as opened,
        one_blas_thread(),
    ):
        process.run(progress, opened)
    made_with = {**settings, **solver.described}
    return fracture_result(scene, process, way, made_with)
