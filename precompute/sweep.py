"""The sweep over all crack cells: parallel, and resumed where it was killed.

Every cell is a task of its own whose result is written to a part file as one atomic rename. A killed sweep
leaves whole parts only; the next run with the same settings takes them over, and since a task runs on one
thread with fixed settings the assembled file is the same as that of an undisturbed run.
"""

from __future__ import annotations

import os
from concurrent.futures import as_completed
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from precompute.crack_cell import solve_cell
from precompute.spec import SweepSpec
from precompute.unbounded import unbounded_compliance
from slmm.running.array_file import read_arrays
from slmm.running.processes import processes
from slmm.running.progress import Progress, silent
from slmm.running.whole_file import whole_file

#: (curvature index, Poisson index); Poisson index -1 is the compliance in an unbounded body
Task = tuple[int, int]


def tasks(spec: SweepSpec) -> list[Task]:
    """All tasks, the slow ones first."""
    curvatures = range(len(spec.curvature))
    return [(i, -1) for i in curvatures] + [(i, j) for i in curvatures for j in range(len(spec.poisson))]


def part_file(folder: Path, task: Task) -> Path:
    """Where the result of a task is kept until the database is assembled."""
    return folder / f"cell_{task[0]:03d}_{task[1] + 1:03d}.npz"


def read_part(folder: Path, task: Task) -> dict[str, np.ndarray]:
    """The result of a task that is done; raises ValueError when its file is damaged (zip keeps a checksum of each)."""
    return read_arrays(
        part_file(folder, task), ("compliance",) if task[1] < 0 else ("K", "stress"), "part of a sweep"
    )


def is_done(folder: Path, task: Task) -> bool:
    """Whether the result of a task is there and sound."""
    try:
        return all(np.isfinite(array).all() for array in read_part(folder, task).values())
    except (ValueError, TypeError):  # not even numbers
        return False


def run_task(spec: SweepSpec, task: Task, folder: Path) -> Task:
    """Solve one cell and write its part file."""
    i, j = task
    lengths = np.array(spec.crack_length)
    with threadpool_limits(1):  # small matrices: more threads are slower, and order of sums would vary
        if j < 0:
            compliance = unbounded_compliance(spec.curvature[i], lengths, spec.orders, spec.fineness)
            result = {"compliance": compliance}
        else:
            cell = solve_cell(
                spec.curvature[i], spec.poisson[j], lengths, spec.eta, spec.mode_list, spec.fineness
            )
            result = {"K": cell.K, "stress": cell.stress}
    with whole_file(part_file(folder, task)) as unfinished, open(unfinished, "wb") as stream:
        np.savez(stream, **result)  # type: ignore[arg-type]
        stream.flush()
        os.fsync(stream.fileno())
    return task


def run_sweep(spec: SweepSpec, folder: Path, workers: int, progress: Progress = silent) -> None:
    """Run every task whose part is not in ``folder`` yet.

    Parameters
    ----------
    spec : SweepSpec
        What to sweep.
    folder : Path
        Folder of the part files; belongs to this spec alone.
    workers : int
        Number of processes; 1 runs in this process.
    progress : callable
        Is told the share of tasks that is done, and their number.
    """
    folder.mkdir(parents=True, exist_ok=True)
    everything = tasks(spec)
    left = [task for task in everything if not is_done(folder, task)]
    done = len(everything) - len(left)

    def tell(done: int) -> None:
        progress(done / len(everything), f"{done} of {len(everything)} crack cells")

    tell(done)
    if workers == 1:
        for number, task in enumerate(left, done + 1):
            run_task(spec, task, folder)
            tell(number)
        return
    # what is under way when one of them fails ends at once
    with processes(workers) as pool:
        futures = [pool.submit(run_task, spec, task, folder) for task in left]
        for number, future in enumerate(as_completed(futures), done + 1):
            future.result()
            tell(number)
