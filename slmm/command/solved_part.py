"""What ``slmm initiation`` is asked about: a scene file, or results of a finite element program with a material."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from slmm.mechanics.material import Material, State
    from slmm.scene.scene import Scene

#: files that are results, whatever options say; others are when a material is given
RESULTS = (".frd", ".vtu", ".pvtu", ".pvd", ".vtk", ".xdmf", ".med", ".msh", ".e", ".exo")


class ResultFlags(NamedTuple):
    """The options that belong to results."""

    material: str | None
    young: float | None
    poisson: float | None
    strength: float | None
    toughness: float | None
    plane_strain: bool
    step: int | None
    field: str | None
    symmetry: tuple[str, ...] = ()


def is_scene(path: Path, flags: ResultFlags) -> bool:
    """Whether a file is taken for a scene."""
    asked = flags.material is not None or flags.strength is not None
    suffix = path.suffix.lower()
    return suffix == ".toml" or not (asked or suffix in RESULTS)


def scene_of(path: Path, flags: ResultFlags, displacements: Path | None) -> Scene:
    """The scene of a scene file, or of results.

    Raises
    ------
    OSError, ValueError
        When it cannot be read, or options do not belong to it.
    """
    if is_scene(path, flags):
        for name, value in flags._asdict().items():
            if value is not None and value is not False and value != () and name != "field":
                raise ValueError(
                    f"--{name.replace('_', '-')}: belongs to results of a finite element program; a scene has its own"
                )
        from slmm.scene.scene import read_scene

        return read_scene(path)
    if displacements is not None:
        raise ValueError(f"--displacements: belongs to a scene; {path.name} has its own")
    from slmm.initiation.solved_scene import solved_scene

    step = -1 if flags.step is None else flags.step
    return solved_scene(path, _material(path, flags), flags.field, step, flags.symmetry)


def _material(path: Path, flags: ResultFlags) -> Material:
    from slmm.mechanics.material import Material

    state: State = "plane strain" if flags.plane_strain else "plane stress"
    constants = {f"--{name}": getattr(flags, name) for name in ("young", "poisson", "strength", "toughness")}
    if flags.material is not None:
        if given := [name for name, value in constants.items() if value is not None]:
            raise ValueError(
                f"--material {flags.material}: has its own constants and contradicts {', '.join(given)}"
            )
        return Material.from_name(flags.material, state)
    if flags.strength is None or flags.toughness is None:
        raise ValueError(f"{path.name}: needs a --material, or --strength and --toughness")
    young, poisson = flags.young, flags.poisson
    if (young is None) != (poisson is None):
        raise ValueError("--young and --poisson belong together: give both, or none")
    if young is None or poisson is None:
        young, poisson = _elasticity_beside(path)
    return Material.from_toughness(young, poisson, flags.strength, flags.toughness, state)


def _elasticity_beside(path: Path) -> tuple[float, float]:
    """E and nu of the only material of the input file beside a .frd file."""
    beside = path.with_suffix(".inp")
    if path.suffix.lower() != ".frd" or not beside.is_file():
        raise ValueError(f"{path.name}: tells no stiffness; give --young and --poisson")
    from slmm.results.inp import read_inp

    found = {known for known in read_inp(beside).materials.values() if known is not None}
    if len(found) != 1:
        raise ValueError(
            f"{beside.name}: has {len(found)} linear elastic materials; give --young and --poisson of the part"
        )
    (only,) = found
    return only.E, only.nu
