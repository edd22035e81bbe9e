"""What a result says about the whole part: will a crack start, and does every position bear that out?"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from slmm.initiation.record import index_with_error, position_record
from slmm.running.labelled import LabelledArrays

if TYPE_CHECKING:
    import xarray as xr

#: what would give the positions without a value one
ASK_AUTO = 'ask method "auto", which has dearer ways'
INSTALL = "install the extra that brings the dearer methods, pip install 'slmm[fea]'"
OWN_MODEL = "leave the displacements out, or give them from a mesh that is finer there"

#: from this relative error on, an index is told by its bounds; a lower one below this share of it is none; chosen
WIDE, NEARLY_NONE = 0.05, 1e-3


class Verdict(NamedTuple):
    """The answer for the whole part.

    Attributes
    ----------
    says : str
        In one to three sentences.
    is_open : bool
        Whether positions without a value leave it open if a crack starts.
    """

    says: str
    is_open: bool


def conclude(result: LabelledArrays | xr.Dataset) -> Verdict:
    """Whether a crack starts, as far as what is known of every position bears it out.

    Parameters
    ----------
    result : Dataset
        Of `slmm.failure_indices`. Without ``failure_index_bound`` nothing is known of positions without a value.

    Examples
    --------
    >>> import numpy as np
    >>> import xarray as xr
    >>> result = xr.Dataset({
    ...     "failure_index": ("position", [0.4, np.nan]),
    ...     "failure_index_error": ("position", [0.01, np.nan]),
    ...     "failure_index_bound": ("position", [0.41, 2.0]),
    ...     "status": ("position", ["ok", "no cell: undercut"]),
    ...     "x": ("position", [1.0, 2.0]),
    ...     "y": ("position", [0.0, 0.0]),
    ... }, attrs={"method": "slmm+ac"})
    >>> conclude(result).is_open
    True
    """
    if "pieces" in result.attrs:
        return Verdict(
            f"The cracks sever the part, in {result.attrs['pieces']} pieces: it does not carry its load from one to the"
            " other any more. Take away a crack, or ask for one piece.",
            is_open=True,
        )
    known = _Known(result)
    worst = known.worst
    if worst is None or not result["failure_index"].values[worst] > 0:
        return _without_index(known)
    FI = float(result["failure_index"].values[worst])
    says = f"Most critical: {_place(result, worst)}"
    at_tip = int(result["hole"].values[worst]) < 0 if "hole" in result else False
    event = "The crack goes on" if at_tip else "A crack starts"
    if FI >= 1:
        says += f". {event} there under this load (FI >= 1{known.closeness(FI)})."
        return Verdict(says + known.may_be_worse(), is_open=False)
    if known.highest_missing >= 1:
        return Verdict(f"{says}. {known.no_verdict()}", is_open=True)
    if known.highest >= 1:
        return Verdict(
            f"{says}. Whether a crack starts under this load lies within the estimated errors: an index may be as high"
            f" as {known.highest:.3f}.",
            is_open=False,
        )
    holds = f"{says}. No crack starts under this load (FI < 1)"
    if known.highest_missing > FI:
        return Verdict(
            f"{holds}: at the {known.count_missing} without a value the strength allows an index of"
            f" {known.highest_missing:.3f} at most. One starts at {1 / FI:.3f} times the load at the latest, and none"
            f" below {1 / known.highest:.3f} times the load.",
            is_open=False,
        )
    if known.highest > (1 + WIDE) * FI:
        latest = f", and one does at {known.latest:.3f} times it" if math.isfinite(known.latest) else ""
        return Verdict(
            f"{holds}; none does below {1 / known.highest:.3f} times the load{latest}.", is_open=False
        )
    return Verdict(f"{holds}; one does at {1 / FI:.3f} times the load.", is_open=False)


def remedy(result: LabelledArrays | xr.Dataset) -> str:
    """What would give values to the positions that have none; empty where that is not known.

    Examples
    --------
    >>> import xarray as xr
    >>> result = xr.Dataset({"status": ("position", ["ok", "no cell: undercut"])}, attrs={"method": "slmm"})
    >>> remedy(result)
    'ask method "auto", which has dearer ways'
    """
    if (result["status"].values == "ok").all():
        return ""
    if "displacements" in result.attrs:
        return OWN_MODEL
    if result.attrs.get("method") != "auto":
        return ASK_AUTO
    if "reason" in result and any("extra 'fea'" in str(reason) for reason in result["reason"].values):
        return INSTALL
    return ""


def _without_index(known: _Known) -> Verdict:
    """No position has an index above zero."""
    if known.worst is None and known.highest_missing >= 1:
        return Verdict(f"No position has a failure index. {known.no_verdict()}", is_open=True)
    if not known.missing.any():
        return Verdict("No crack starts at any of the positions, however high the load.", is_open=False)
    if known.highest_missing >= 1:
        return Verdict(known.no_verdict(), is_open=True)
    return Verdict(
        f"No crack starts under this load: at the {known.count_missing} without a value the strength allows an index of"
        f" {known.highest_missing:.3f} at most"
        + (", and the others carry no tension." if known.worst is not None else "."),
        is_open=False,
    )


class _Known:
    """What is known of all positions together."""

    def __init__(self, result: LabelledArrays | xr.Dataset):
        self.result = result
        FI = result["failure_index"].values.astype(float)
        status = result["status"].values.astype(str) if "status" in result else np.full(len(FI), "ok")
        self.missing = ~np.isfinite(FI) | (status != "ok")
        if "failure_index_bound" in result:
            bound = result["failure_index_bound"].values.astype(float)
        else:
            bound = np.where(self.missing, np.inf, FI + np.nan_to_num(self._errors(), nan=0.0))
        # a bound that is not a number bounds nothing
        self.bound = np.where(np.isnan(bound), np.inf, bound)
        self.worst = None if self.missing.all() else int(np.argmax(np.where(self.missing, -np.inf, FI)))

    def _errors(self) -> np.ndarray:
        return self.result["failure_index_error"].values.astype(float)

    @property
    def highest(self) -> float:
        """Largest bound of all positions."""
        return float(self.bound.max(initial=0.0))

    @property
    def highest_missing(self) -> float:
        """Largest bound of the positions without a value."""
        return float(np.max(self.bound[self.missing], initial=0.0))

    @property
    def count_missing(self) -> str:
        """Number of positions without a value, in words."""
        n = int(self.missing.sum())
        return f"{n} position{'s' * (n > 1)}"

    @property
    def latest(self) -> float:
        """Load factor at which a crack starts for certain; infinite where the errors leave that open."""
        FI = np.where(self.missing, np.nan, self.result["failure_index"].values.astype(float))
        least = np.nanmax(FI - np.nan_to_num(self._errors()))
        return float(1 / least) if least > NEARLY_NONE * np.nanmax(FI) else math.inf

    def closeness(self, FI: float) -> str:
        """What to add to an index of at least 1."""
        assert self.worst is not None
        error = float(self._errors()[self.worst])
        return ", by less than the estimated error" if FI - error < 1 else ""

    def may_be_worse(self) -> str:
        """A sentence on positions without a value that may be more critical; empty where none may."""
        assert self.worst is not None
        if self.highest_missing <= self.result["failure_index"].values[self.worst]:
            return ""
        limit = f": {self.highest_missing:.3f} at most" if math.isfinite(self.highest_missing) else ""
        return f" At {self.count_missing} without a value the index may be higher{limit}."

    def no_verdict(self) -> str:
        """Why there is none, and what would give one."""
        i = int(np.argmax(np.where(self.missing, self.bound, -np.inf)))
        result = self.result
        where = f"({float(result['x'].values[i]):.2f}, {float(result['y'].values[i]):.2f}) mm"
        bound = self.bound[i]
        known = (
            f"the strength allows an index of {bound:.3g}"
            if math.isfinite(bound)
            else "nothing bounds the index"
        )
        open_ones = int((self.bound[self.missing] >= 1).sum())
        says = (
            f"No verdict: {self.count_missing} of {len(self.missing)} have no value, and a crack may start at"
            f" {open_ones} of these; at {where} {known} ({result['status'].values[i]})."
        )
        helps = remedy(result)
        return f"{says} For a verdict {helps}." if helps else says


def _place(result: LabelledArrays | xr.Dataset, i: int) -> str:
    """Position i with what was found there."""
    record = position_record(result, i)
    at_tip = record.get("hole", 0) < 0
    says = f"position {i}{', a crack tip,' if at_tip else ''} at ({record['x']:.2f}, {record['y']:.2f}) mm"
    says += f", failure index {index_with_error(result, i)}, load factor {1 / record['failure_index']:.3f}"
    length = record.get("crack_length")
    return says + (f", critical crack length {length:.3g} mm" if length else "")
