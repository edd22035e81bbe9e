"""Cracks, material, load and analysis as tables of a scene file."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, field_validator, model_validator

from slmm.mechanics.material import LEAST, MATERIALS, MOST, Material, State
from slmm.scene.values import Constant, Count, Number, PlanePoints, Table, exactly_one

Method = Literal[
    "rankine",
    "mises",
    "point",
    "line",
    "slmm",
    "slmm+ac",
    "asymptotics",
    "griffith",
    "boundary",
    "dislocations",
    "full-fea",
    "auto",
]


Criterion = Literal["coupled", "rankine", "point", "line", "griffith"]


class Crack(Table):
    """Initial crack along points (mm): an end in the material is a tip, others lie on a surface or another crack."""

    points: Annotated[PlanePoints, Field(min_length=2)]


class MaterialTable(Table):
    """Material by its name, or by its constants with exactly one of K_Ic (MPa sqrt(m)) and G_c (N/mm)."""

    name: str | None = None
    E: Constant | None = None
    nu: Annotated[Number, Field(gt=-1, lt=0.5)] | None = None
    sigma_c: Constant | None = None
    K_Ic: Constant | None = None
    G_c: Constant | None = None
    state: State = "plane stress"

    CONSTANTS: ClassVar[tuple[str, ...]] = ("E", "nu", "sigma_c", "K_Ic", "G_c")

    @field_validator("name")
    @classmethod
    def _is_known(cls, name: str | None) -> str | None:
        if name is not None and name not in MATERIALS:
            raise ValueError(f"must be one of {', '.join(MATERIALS)}, or give E, nu, sigma_c and K_Ic or G_c")
        return name

    @model_validator(mode="after")
    def _is_complete(self) -> Self:
        given = [key for key in self.CONSTANTS if getattr(self, key) is not None]
        if self.name is not None:
            if given:
                raise ValueError(
                    f'name = "{self.name}" has its own constants and contradicts {", ".join(given)};'
                    " give the name or the constants"
                )
            return self
        missing = [key for key in ("E", "nu", "sigma_c") if key not in given]
        if missing:
            known = ", ".join(f'"{name}"' for name in MATERIALS)
            raise ValueError(
                f"{', '.join(missing)} missing; needs a name ({known}), or E, nu, sigma_c and K_Ic or G_c"
            )
        exactly_one(self, ("K_Ic", "G_c"))
        return self

    def material(self) -> Material:
        """The material with its constants in N, mm, MPa."""
        if self.name is not None:
            return Material.from_name(self.name, self.state)
        assert self.E is not None and self.nu is not None and self.sigma_c is not None
        if self.K_Ic is not None:
            return Material.from_toughness(self.E, self.nu, self.sigma_c, self.K_Ic, self.state)
        assert self.G_c is not None
        return Material(self.E, self.nu, self.sigma_c, self.G_c, self.state)


class Load(Table):
    """Exactly one kind of load; the others are None.

    ``strain`` (e_xx, e_yy, gamma_xy) prescribes the displacement of all four edges, ``displacement`` (mm)
    moves the top edge up as one, ``stress`` (MPa) pulls uniformly on top and bottom.
    """

    strain: tuple[Number, Number, Number] | None = None
    displacement: Number | None = None
    stress: Number | None = None

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        exactly_one(self, ("strain", "displacement", "stress"))
        value = self.strain or (self.displacement or self.stress,)
        if not any(value):
            raise ValueError("is zero; without a load there is no failure to predict")
        size = max(abs(x) for x in value if x is not None)
        if not LEAST <= size <= MOST:
            raise ValueError(f"is {size:g}; the largest number must lie between {LEAST:g} and {MOST:g}")
        return self


class Analysis(Table):
    """How to compute: the method, where, and with how fine a model.

    ``points`` (mm), when given, take the place of ``positions`` equally spaced ones on every hole.
    ``void_stiffness`` is the stiffness of a hole's voxels as a share of the material's. ``settings`` are the
    package's own or those that Paper A published. ``average`` compares the mean stress over the crack with the
    strength (thesis Eq. 3.21). ``criterion`` judges what a method finds that is no criterion itself, in place of the
    coupled one. ``tolerance`` is the relative error of the failure index that the method "auto"
    aims at; of indices below a quarter of the largest it is that of the quarter. ``local_model`` is what crack
    cells and strength criteria take the uncracked part's field from. ``direction`` is where cracks go: normal to the
    surface, or turned into the direction that needs the least load.
    """

    method: Method = "auto"
    positions: Annotated[Count, Field(ge=1, le=100_000)] = 50
    points: Annotated[PlanePoints, Field(min_length=1)] | None = None
    voxels: Literal["auto"] | Count = "auto"
    void_stiffness: Annotated[Number, Field(ge=1e-9, le=0.1)] = 1e-6
    settings: Literal["default", "published"] = "default"
    local_model: Literal["auto", "voxels", "body-fitted", "boundary"] = "auto"
    average: Annotated[bool, Field(strict=True)] = False
    criterion: Criterion | None = None
    tolerance: Annotated[Number, Field(ge=0.0005, le=0.5)] = 0.02
    direction: Literal["normal", "best"] = "normal"

    @field_validator("voxels", mode="before")
    @classmethod
    def _number_of_voxels(cls, voxels: object) -> object:
        whole = isinstance(voxels, int) and not isinstance(voxels, bool)
        if voxels != "auto" and not (whole and 100 <= voxels <= 100_000_000):  # type: ignore[operator]
            raise ValueError('must be "auto" or a whole number between 100 and 100000000')
        return voxels

    @model_validator(mode="after")
    def _no_contradictions(self) -> Self:
        if self.points is not None and "positions" in self.model_fields_set:
            raise ValueError("positions and points contradict each other; give one of them")
        if self.average and self.criterion not in (None, "coupled"):
            raise ValueError(f'average = true contradicts criterion = "{self.criterion}"; give one of them')
        return self
