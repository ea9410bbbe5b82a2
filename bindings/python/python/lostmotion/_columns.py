"""Columns of numbers by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Mapping, Sequence

import numpy as np

if TYPE_CHECKING:
    import pandas

Arrays = list[tuple[str, "np.ndarray[Any, Any]"]]


class Columns(dict[str, "np.ndarray[Any, Any]"]):
    """Arrays by name: a row per recorded period, and a column per joint if there are many joints.

    Attributes:
        time_s: time at the end of each recorded period [s], shape (rows,); None if the columns have no common time.
    """

    time_s: "np.ndarray[Any, Any] | None"

    def __init__(self, arrays: Mapping[str, "np.ndarray[Any, Any]"], time_s: "np.ndarray[Any, Any] | None" = None) -> None:
        super().__init__(arrays)
        self.time_s = time_s

    def frame(self) -> "pandas.DataFrame":
        """Returns a dataframe with a column per quantity, or per quantity and joint; needs pandas."""
        try:
            import pandas
        except ImportError as error:
            raise ImportError("frame() needs pandas: pip install pandas") from error
        index = None if self.time_s is None else pandas.Index(self.time_s, name="time_s")
        if all(values.ndim == 1 for values in self.values()):
            return pandas.DataFrame(dict(self), index=index)
        parts = {name: pandas.DataFrame(values, index=index) for name, values in self.items()}
        return pandas.concat(parts, axis=1, names=["quantity", "joint"])


def allocated(
    types: Sequence[tuple[str, str]],
    record: Sequence[str] | None,
    out: Mapping[str, "np.ndarray[Any, Any]"] | None,
    shape: tuple[int, int],
) -> Arrays:
    """Arrays that the compiled half fills: those of `out`, or new ones for the names of `record`."""
    known = dict(types)
    names = list(out) if record is None and out is not None else list(known) if record is None else list(record)
    unknown = [name for name in names if name not in known]
    if unknown:
        raise KeyError(f"{unknown[0]!r} is not one of {', '.join(known)}")
    given = out or {}
    return [(name, given[name] if name in given else np.zeros(shape, dtype=known[name])) for name in names]


def spread(values: Any, kind: Any, periods: int, n: int) -> "np.ndarray[Any, Any]":
    """Array of the shape (periods, n) without a copy: from a scalar, from (periods,), or as it is."""
    array = np.asarray(values, dtype=kind)
    if array.ndim == 1:
        array = array[:, np.newaxis]
    return np.broadcast_to(array, (periods, n))


def periods_of(values: Sequence[Any], steps: int | None) -> int:
    """Number of periods: `steps`, or the rows of the first array."""
    if steps is not None:
        return steps
    for value in values:
        if np.ndim(value) > 0:
            return len(value)
    raise ValueError("the number of periods is unknown: pass an array, or steps=")


def time_axis(periods: int, every: int, rate: int) -> "np.ndarray[Any, Any]":
    """Times at the ends of the recorded periods [s]."""
    return np.arange(1, periods // every + 1) * (every / rate)
