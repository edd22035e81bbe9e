"""A fracture process as a moving picture: cracks as they grow, and the force over the displacement as it comes."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.figure import Figure

from slmm.fracture.critical_state import critical_state, number_of_states
from slmm.pictures.cracked_part import draw_cracks, draw_open_part, draw_part
from slmm.pictures.fracture import check_magnified
from slmm.pictures.style import CRITICAL, PALETTE, STYLE
from slmm.running.progress import Progress, silent
from slmm.running.whole_file import whole_file
from slmm.scene.scene import Scene

#: pictures in a second, how often the last one stands, and dots per inch; chosen
PER_SECOND, LAST, RESOLUTION = 4, 6, 80
#: how names of moving pictures may end
FORMATS = (".gif", ".mp4")


def animate_fracture(
    scene: Scene,
    result: xr.Dataset,
    path: str | Path,
    magnified: float = 0.0,
    progress: Progress = silent,
) -> None:
    """Write a moving picture, of one frame before each step and one at the end.

    Parameters
    ----------
    scene : Scene
        What was simulated.
    result : Dataset
        From `slmm.fracture.simulate`.
    path : str or Path
        A .gif, or an .mp4 where ffmpeg is installed.
    magnified : float
        How many times as large displacements are drawn, which shows cracks open, each frame at the load at which its
        step happens; 0 for none.
    progress : callable

    Raises
    ------
    ValueError
        For a name with another ending, an .mp4 without ffmpeg, or a magnification that is negative.
    NotWrittenError
        When the file cannot be written.

    Examples
    --------
    >>> from slmm.fracture import simulate
    >>> from slmm.scene.gallery import tensile_plate
    >>> scene = tensile_plate()
    >>> result = simulate(scene, increment=16.0, errors=False)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     animate_fracture(scene, result, Path(folder, "fracture.gif"))
    ...     Path(folder, "fracture.gif").read_bytes()[:6]
    b'GIF89a'
    """
    path = Path(path)
    check_magnified(magnified)
    writer = _writer(path)
    frames = result.sizes["step"] + 1
    with matplotlib.rc_context(STYLE), tempfile.TemporaryDirectory() as folder:  # type: ignore[arg-type]
        figure = Figure(figsize=(11.0, 5.0))
        # nothing moves from frame to frame
        part, curve = figure.subplots(
            1, 2, gridspec_kw={"left": 0.07, "right": 0.98, "bottom": 0.12, "top": 0.9}
        )
        drawn = Path(folder, "drawn").with_suffix(path.suffix.lower())
        with writer.saving(figure, str(drawn), RESOLUTION):
            for k in range(frames):
                progress(k / frames, f"picture {k + 1} of {frames}")
                part.clear()
                curve.clear()
                if magnified and k < number_of_states(result):
                    draw_open_part(part, scene, result, critical_state(scene, result, k), magnified)
                else:
                    draw_part(part, scene)
                    draw_cracks(part, result, k)
                _draw_curve(curve, result, k)
                figure.suptitle(_title(result, k))
                for _ in range(LAST if k + 1 == frames else 1):
                    writer.grab_frame()
        with whole_file(path) as unfinished:
            shutil.copyfile(drawn, unfinished)


def check_can_animate(path: Path) -> None:
    """Refuse before the long work a format that could not be written after it."""
    _writer(path)


def _writer(path: Path) -> AbstractMovieWriter:
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise ValueError(f"{path}: the name of a moving picture must end with {' or '.join(FORMATS)}")
    if suffix == ".gif":
        return PillowWriter(fps=PER_SECOND)
    if shutil.which("ffmpeg") is None:
        raise ValueError(f"{path}: ffmpeg, which writes .mp4, is not installed; a .gif needs nothing")
    return FFMpegWriter(fps=PER_SECOND)


def _title(result: xr.Dataset, step: int) -> str:
    """What happens next."""
    if step == result.sizes["step"]:
        return f"$U_T$ = {float(result.U_T):.5g} mJ"
    happens = {"growth": "grows", "start": "starts"}[result.event.values[step].item()]
    return f"step {step + 1}: crack {int(result.tip[step])} {happens} at u = {float(result.u_c[step]):.3g} mm"


def _draw_curve(axes: matplotlib.axes.Axes, result: xr.Dataset, step: int) -> None:
    """F(u) up to a step, over the whole of it."""
    u, F = result.u.values, result.F.values
    axes.plot(u, F, color="0.8", lw=1.0)
    if step < result.sizes["step"]:
        u_now = float(result.u_load[step])
        F_now = float(result.stiffness[step]) * u_now
        at = (float(result.u_c[step]), float(result.stiffness[step] * result.u_c[step]))
        before = u < u_now
        u, F = np.append(u[before], u_now), np.append(F[before], F_now)
        if float(result.u_c[step]) < u_now:  # the top of the drop on which it stands
            top = float(result.F.values[result.u.values == u_now].max())
            u, F = np.insert(u, -1, u_now), np.insert(F, -1, top)
        axes.plot(*at, "o", color=CRITICAL, ms=5, zorder=4)
    axes.plot(u, F, color=PALETTE[0], lw=2.0, zorder=3)
    axes.fill_between(u, F, color=PALETTE[4], alpha=0.3, lw=0)
    axes.set(xlabel="displacement u in mm", ylabel="force F in N", ylim=(0, None), xlim=(0, None))
