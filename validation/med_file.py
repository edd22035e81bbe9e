"""A MED file as Code_Aster writes one: nodal displacements DX, DY under a name filled up to eight letters."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

#: MED's names of kinds of elements
TYPES = {"triangle": "TR3", "triangle6": "TR6", "quad": "QU4", "quad8": "QU8"}
WHOLE = b"MED_NO_PROFILE_INTERNAL"


def write_med(path: Path, points: np.ndarray, kind: str, nodes: np.ndarray, u: np.ndarray) -> None:
    """Write a plane mesh with displacements (n, 2) at one time."""
    with h5py.File(path, "w") as file:
        info = file.create_group("INFOS_GENERALES")
        info.attrs.update({"MAJ": 4, "MIN": 0, "REL": 0})
        mesh = file.create_group("ENS_MAA/MAIL")
        mesh.attrs.update({"DIM": 2, "ESP": 2, "REP": 0, "SRT": 1, "TYP": 0})
        mesh.attrs.update({"NOM": np.bytes_("X               Y"), "UNI": np.bytes_(""), "UNT": np.bytes_("")})
        step = mesh.create_group("-0000000000000000001-0000000000000000001")
        step.attrs.update({"CGT": 1, "NDT": -1, "NOR": -1, "PDT": -1.0})
        at = step.create_group("NOE")
        at.attrs.update({"CGT": 1, "CGS": 1, "PFL": np.bytes_(WHOLE)})
        _values(at, "COO", points.T.ravel(), len(points))
        _values(at, "FAM", np.zeros(len(points), np.int32), len(points))
        elements = step.create_group(f"MAI/{TYPES[kind]}")
        elements.attrs.update({"CGT": 1, "CGS": 1, "PFL": np.bytes_(WHOLE)})
        _values(elements, "NOD", (nodes + 1).T.ravel().astype(np.int32), len(nodes))
        _values(elements, "FAM", np.full(len(nodes), -1, np.int32), len(nodes))
        family = file.create_group("FAS/MAIL/FAMILLE_ZERO")
        family.attrs["NUM"] = 0
        called = "RESU____DEPL"
        field = file.create_group(f"CHA/{called}")
        field.attrs.update({"MAI": np.bytes_("MAIL"), "NCO": 2, "TYP": 6, "UNT": np.bytes_("")})
        field.attrs.update({"NOM": np.bytes_("DX              DY"), "UNI": np.bytes_(32 * " ")})
        time = field.create_group("0000000000000000000100000000000000000001")
        time.attrs.update({"NDT": 1, "NOR": 1, "PDT": 1.0, "RDT": -1, "ROR": -1})
        on = time.create_group("NOE")
        on.attrs.update({"GAU": np.bytes_(""), "PFL": np.bytes_(WHOLE)})
        profile = on.create_group(WHOLE.decode())
        profile.attrs.update({"GAU": np.bytes_(""), "NBR": len(points), "NGA": 1})
        profile.create_dataset("CO", data=u.T.ravel())


def _values(group: h5py.Group, name: str, values: np.ndarray, count: int) -> None:
    group.create_dataset(name, data=values).attrs.update({"CGT": 1, "NBR": count})
