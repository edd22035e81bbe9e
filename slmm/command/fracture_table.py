"""A fracture process in a terminal: the runs of each crack, and what came of it all."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from rich.table import Table

from slmm.command.terminal import console, number_text, table_box

if TYPE_CHECKING:
    import xarray as xr

#: what drops of the force leave out of U_T is told from this share on; chosen
STEADY = 0.01


def print_fracture(result: xr.Dataset) -> None:
    """The runs of each crack, and what came of it all."""
    out = console()
    table = Table(title=result.attrs["title"] or "Fracture", box=table_box(out))
    for heading in (
        "steps",
        "crack",
        "from x\nmm",
        "from y\nmm",
        "to x\nmm",
        "to y\nmm",
        "u\nmm",
        "F before\nN",
    ):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("then")
    for first, last in _runs(result):
        crack = int(result.tip[first])
        x, y, step = (result[name].values[crack] for name in ("crack_x", "crack_y", "crack_step"))
        at = int((step == first).argmax())
        start = at if result.event.values[first] == "start" else _neighbour(step, at)
        where = (x[start], y[start], float(result.x[last]), float(result.y[last]))
        u = float(result.u_load[first])
        table.add_row(
            f"{first + 1} to {last + 1}" if last > first else str(first + 1),
            str(crack),
            *(number_text(value, ".2f") for value in where),
            number_text(u, ".4f"),
            number_text(float(result.stiffness[first]) * u, ".1f"),
            str(result.arrested_by.values[last]) or "goes on",
        )
    if result.sizes["step"]:
        out.print(table)
    error = float(result.U_T_error)
    told = f" (error ± {error:.2g} mJ)" if error == error else ""
    out.print(
        f"Tensile toughness U_T = {float(result.U_T):.5g} mJ{told}; {result.attrs['outcome']}.",
        soft_wrap=True,
    )
    more = float(result.U_T_integrated - result.U_T)
    if more > STEADY * float(result.U_T):
        error = float(result.U_T_integrated_error)
        told = f" (error ± {error:.2g} mJ)" if error == error else ""
        out.print(
            "Cracks grow steadily for a while: with a force that falls steadily, too, U_T = "
            f"{float(result.U_T_integrated):.5g} mJ{told}.",
            soft_wrap=True,
        )
    if (step := int(result.peak_step)) >= 0:
        out.print(
            f"Largest force {float(result.F_peak):.5g} N; if the force is controlled, the part breaks in step "
            f"{step + 1}.",
            soft_wrap=True,
        )
    if count := result.attrs["competing_events"]:
        out.print(
            f"In {count} of {result.sizes['step']} steps another event was within 0.5 % of the load: the path may fork"
            " there.",
            soft_wrap=True,
        )
    if result.sizes["loose"]:
        after = ", ".join(str(step + 1) for step in result.loose_step.values.tolist())
        out.print(
            f"Pieces came loose that carry nothing, and were taken away: {result.sizes['loose']}, after step {after}.",
            soft_wrap=True,
        )
    if forks := int(result.attrs.get("forking_directions", 0)):
        out.print(
            f"In {forks} steps two directions were alike, as T bends the path: it may go either way there.",
            soft_wrap=True,
        )
    if touches := int(result.touches.sum()):
        out.print(
            f"In {touches} steps faces of cracks hold each other, {result.attrs['contact']}, over "
            f"{float(result.closed.max()):.3g} mm at most.",
            soft_wrap=True,
        )


def _runs(result: xr.Dataset) -> list[tuple[int, int]]:
    """First and last steps of stretches in which one crack grows at one displacement."""
    crack, u = result.tip.values, result.u_load.values
    first = [k for k in range(len(crack)) if k == 0 or crack[k] != crack[k - 1] or u[k] != u[k - 1]]
    return [(a, b - 1) for a, b in pairwise([*first, len(crack)])]


def _neighbour(step: list[float], at: int) -> int:
    """The point of a crack that was there before the one ``at`` which it grew to."""
    return at - 1 if at > 0 and step[at - 1] < step[at] else at + 1
