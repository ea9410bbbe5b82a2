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
    inputs: Sequence["np.ndarray[Any, Any] | None"] = (),
) -> Arrays:
    """Arrays that the compiled half fills: those of `out`, or new ones for the names of `record`.

    Raises:
        KeyError: if a name is not a quantity.
        ValueError: if an array of `out` cannot be filled in place, or overlaps another one or an array of `inputs`.
    """
    known = dict(types)
    if isinstance(record, str):
        record = [record]
    names = list(out) if record is None and out is not None else list(known) if record is None else list(record)
    unknown = [name for name in names if name not in known]
    if unknown:
        raise KeyError(f"{unknown[0]!r} is not one of {', '.join(known)}")
    given = out or {}
    for name, array in given.items():
        _check_output(name, array, known[name], shape)
    filled = list(given.items())
    for index, (name, array) in enumerate(filled):
        for other, its in filled[:index]:
            if _overlap(array, its):
                raise ValueError(f"out[{name!r}] overlaps out[{other!r}]: pass separate arrays")
        if any(it is not None and _overlap(array, it) for it in inputs):
            raise ValueError(f"out[{name!r}] overlaps an input: pass a separate array")
    return [(name, given[name] if name in given else np.zeros(shape, dtype=known[name])) for name in names]


def _check_output(name: str, array: Any, kind: str, shape: tuple[int, int]) -> None:
    """Refuses an array that the compiled half cannot fill in place."""
    if not isinstance(array, np.ndarray):
        raise TypeError(f"out[{name!r}] is a {type(array).__name__}, not an array of numpy")
    dtype = np.dtype(kind)
    if array.dtype != dtype:
        raise ValueError(f"out[{name!r}] has the type {array.dtype.str}, not {dtype.str} ({kind})")
    if array.shape != shape:
        raise ValueError(f"out[{name!r}] has the shape {array.shape}, not {shape} (rows, joints)")
    if not array.flags.writeable:
        raise ValueError(f"out[{name!r}] is not writeable")
    if not array.flags.aligned:
        raise ValueError(f"out[{name!r}] is not aligned: fields of a packed record cannot be filled in place")
    # An element lies apart from the others if each stride exceeds the extent of the smaller ones.
    extent = array.itemsize
    for stride, length in sorted((abs(stride), length) for stride, length in zip(array.strides, array.shape) if length > 1):
        if stride < extent:
            raise ValueError(f"out[{name!r}] overlaps itself: several of its elements lie at one address")
        extent += stride * (length - 1)


def _overlap(one: "np.ndarray[Any, Any]", other: "np.ndarray[Any, Any]") -> bool:
    """Returns True if two arrays share an element, or if that is not decided with little work."""
    if not np.may_share_memory(one, other):
        return False
    try:
        return np.shares_memory(one, other, max_work=10_000)
    except Exception:  # TooHardError, which numpy has moved between its versions.
        return True


def spread(name: str, values: Any, kind: Any, periods: int, n: int) -> "np.ndarray[Any, Any]":
    """Finite numbers of the shape (periods, n), without a copy if type and alignment fit: from a scalar, from (periods,),
    from (1, n), or as they are.

    Raises:
        ValueError: with name, row and joint if the shape is another one or a number is not finite.
    """
    with np.errstate(over="ignore"):
        array = np.require(values, dtype=kind, requirements="AE")
    _check_shape(name, array, periods, n)
    finite = np.isfinite(array)
    if not finite.all():
        raise ValueError(f"{name} is {array[~finite][0]} {_place(~finite)}: every number must be finite as {np.dtype(kind)}")
    return _broadcast(array, periods, n)


def spread_counts(
    name: str, values: Any, periods: int, n: int, *, gaps: bool = False
) -> tuple["np.ndarray[Any, Any]", "np.ndarray[Any, Any] | None"]:
    """Counts as uint32 of the shape (periods, n), without a copy if they are uint32, and True where there is no reading.

    Args:
        name: name for errors.
        values: counts; whole numbers of any type.
        periods: rows.
        n: joints.
        gaps: True takes NaN as no reading.

    Raises:
        ValueError: with name, row and joint if a number is not a count.
    """
    array = np.asarray(values)
    _check_shape(name, array, periods, n)
    missing = None
    if array.dtype != np.uint32:
        if array.dtype.kind not in "iuf":
            raise TypeError(f"{name} has the type {array.dtype}: pass whole numbers, such as uint32")
        if gaps and array.dtype.kind == "f" and np.isnan(array).any():
            missing = np.isnan(array)
            array = np.where(missing, 0, array)
        wrong = ~((array >= 0) & (array < 2**32))
        if array.dtype.kind == "f":
            wrong |= array != np.floor(array)
        if wrong.any():
            raise ValueError(f"{name} is {array[wrong][0]} {_place(wrong)}: counts are whole numbers from 0 to 2**32 - 1")
    array = np.require(array, dtype=np.uint32, requirements="AE")
    return _broadcast(array, periods, n), None if missing is None else _broadcast(missing, periods, n)


def _check_shape(name: str, array: "np.ndarray[Any, Any]", periods: int, n: int) -> None:
    if array.shape not in ((), (periods,), (periods, 1), (1, n), (periods, n)):
        raise ValueError(f"{name} has the shape {array.shape}, not ({periods}, {n}) (periods, joints) or ({periods},)")


def _broadcast(array: "np.ndarray[Any, Any]", periods: int, n: int) -> "np.ndarray[Any, Any]":
    return np.broadcast_to(array[:, np.newaxis] if array.ndim == 1 else array, (periods, n))


def _place(wrong: "np.ndarray[Any, Any]") -> str:
    """Row and joint of the first True."""
    at = np.argwhere(wrong)[0]
    return " and ".join(f"{axis} {index}" for axis, index in zip(("in row", "joint"), at)) or "as a number"


def periods_of(values: Mapping[str, Any], steps: int | None) -> int:
    """Number of periods: the rows that the arrays have in common, or `steps`.

    Raises:
        ValueError: with the names, if the arrays differ in their rows, or if nothing gives a number.
    """
    shapes = {name: np.shape(value) for name, value in values.items()}
    rows = {name: shape[0] for name, shape in shapes.items() if shape and not (len(shape) == 2 and shape[0] == 1)}
    if steps is not None:
        if steps < 0:
            raise ValueError(f"steps is {steps}: pass 0 or more")
        rows["steps"] = int(steps)
    if not rows and any(shapes.values()):
        return 1
    if not rows:
        raise ValueError("the number of periods is unknown: pass an array, or steps=")
    if len(set(rows.values())) > 1:
        listed = ", ".join(f"{name} {count}" for name, count in rows.items())
        raise ValueError(f"the arrays have different numbers of periods: {listed}")
    return next(iter(rows.values()))


def checked_every(every: int) -> int:
    """Periods per recorded row.

    Raises:
        ValueError: if it is below 1.
    """
    if every < 1:
        raise ValueError(f"every is {every}: it must be 1 or more")
    return int(every)


def time_axis(periods: int, every: int, rate: int) -> "np.ndarray[Any, Any]":
    """Times at the ends of the recorded periods [s]."""
    return np.arange(1, periods // every + 1) * (every / rate)
