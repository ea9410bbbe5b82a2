"""Plants."""

from __future__ import annotations

import os
from typing import Any, Mapping, NoReturn, Sequence

import numpy as np

from . import _native
from ._columns import Columns, allocated, checked_every, periods_of, spread, time_axis
from ._joint import Joint, JointLike, shared
from ._process import claim

QUANTITIES = _native.PLANT_COLUMNS
"""Recorded quantities of a plant: names, and types of numpy."""
USUAL = ("motor_angle_rad", "link_angle_rad", "gap_m")
"""Quantities that many plants record by default."""


def joints_of(joint: "JointLike | Sequence[JointLike]", n: int | None) -> tuple[list[_native.Joint], int]:
    """Compiled joints, and their number."""
    if isinstance(joint, (Joint, str, os.PathLike, Mapping)):
        joint, n = [joint], 1 if n is None else n
    joints = shared(joint)
    if not joints or (n is not None and len(joints) not in (1, n)) or (n is not None and n < 1):
        raise ValueError(f"{n} joints are wanted and {len(joints)} are given")
    return [it.native for it in joints], len(joints) if n is None else n


class Plants:
    """Plants of many joints: gears with backlash, motor, current loop, frictions, weight, encoders. The step has the bits
    of the board's. Periods of different joints run on all cores, without Python's lock.

    Args:
        joint: one joint for all, or a sequence with a joint each.
        n: number of plants; may be left out for a sequence.
        rate: control rate [Hz]; the joint file's if left out.

    Raises:
        JointError: if the joint cannot be stepped at this rate, or has an effect that the board's plant does not model.
    """

    native: _native.Plants

    def __init__(self, joint: "JointLike | Sequence[JointLike]", n: int | None = None, *, rate: int | None = None) -> None:
        joints, count = joints_of(joint, n)
        claim()
        self.native = _native.Plants(joints, count, rate)

    def __len__(self) -> int:
        return len(self.native)

    @property
    def rate_Hz(self) -> int:
        """Control rate [Hz]."""
        return self.native.rate

    def step(
        self,
        torque: Any,
        load: Any = 0.0,
        *,
        steps: int | None = None,
        every: int = 1,
        record: Sequence[str] | None = USUAL,
        out: Mapping[str, "np.ndarray[Any, Any]"] | None = None,
    ) -> Columns:
        """Advances every plant by a control period per row.

        Args:
            torque: torque commands of the motors [N m], shape (periods, n); (periods,) commands all plants alike.
                float32 arrays are read in place.
            load: torques that brake the links [N m], of the same shapes.
            steps: number of periods, if neither is an array.
            every: periods per recorded row.
            record: names of the recorded quantities; None records all, an empty tuple none.
            out: arrays of the shape (periods // every, n) to be filled in place, by name.

        Returns:
            Arrays of the shape (periods // every, n): row i is the state after period (i + 1) * every.

        Raises:
            ValueError: with the name, if a number is not finite, or if an array does not fit or cannot be filled in place.
            KeyboardInterrupt: after Ctrl-C; the plants stand at the period that they had reached.
        """
        claim()
        periods, n, every = periods_of({"torque": torque, "load": load}, steps), len(self), checked_every(every)
        inputs = [spread(name, it, np.float32, periods, n) for name, it in (("torque", torque), ("load", load))]
        arrays = allocated(QUANTITIES, record if out is None else None, out, (periods // every, n), inputs)
        self.native.step(*inputs, every, arrays)
        return Columns(dict(arrays), time_axis(periods, every, self.rate_Hz))

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        raise TypeError("a plant is not copied or pickled: make a new one of the same joint and step it by the same torques")

    def state(self, record: Sequence[str] | None = None) -> Columns:
        """Present state: arrays of the shape (n,); `record` names the quantities, None is all."""
        arrays = allocated(QUANTITIES, record, None, (1, len(self)))
        self.native.state(arrays)
        return Columns({name: values[0] for name, values in arrays})

    def reset(self) -> None:
        """Returns every plant to rest at angle zero."""
        self.native.reset()

    def digests(self) -> "np.ndarray[Any, Any]":
        """Digests over every bit of the gears' states, shape (n,), uint64: equal on every host and board."""
        return np.array(self.native.digests(), dtype=np.uint64)

    def tables(self, index: int = 0) -> bytes:
        """Tables of a plant, as the file `*_tables.bin` that `joint tables` writes for C programs."""
        found = self.native.tables(index)
        if found is None:
            raise IndexError(index)
        return found


class Plant(Plants):
    """Plant of one joint: as `Plants`, with arrays of the shape (periods,).

    Args:
        joint: joint, or name of a preset or joint file.
        rate: control rate [Hz]; the joint file's if left out.
    """

    def __init__(self, joint: JointLike, *, rate: int | None = None) -> None:
        super().__init__(joint, 1, rate=rate)

    def step(
        self,
        torque: Any,
        load: Any = 0.0,
        *,
        steps: int | None = None,
        every: int = 1,
        record: Sequence[str] | None = None,
        out: Mapping[str, "np.ndarray[Any, Any]"] | None = None,
    ) -> Columns:
        """Advances by a control period per element; arguments as in `Plants.step`, arrays of the shape (periods,).

        Returns:
            Arrays of the shape (periods // every,); all quantities unless `record` names some.
        """
        return flat(super().step(torque, load, steps=steps, every=every, record=record, out=with_joints(out)))


def with_joints(out: Mapping[str, "np.ndarray[Any, Any]"] | None) -> Mapping[str, "np.ndarray[Any, Any]"] | None:
    """Arrays of one joint with an axis of joints."""
    wrong = [name for name, values in (out or {}).items() if np.ndim(values) != 1]
    if wrong:
        raise ValueError(f"out[{wrong[0]!r}] must have the shape (rows,)")
    return None if out is None else {name: values[:, np.newaxis] for name, values in out.items()}


def flat(columns: Columns) -> Columns:
    """Columns of one joint, without the axis of joints."""
    return Columns({name: values[:, 0] for name, values in columns.items()}, columns.time_s)
