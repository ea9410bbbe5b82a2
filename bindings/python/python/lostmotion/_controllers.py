"""Observers and controllers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, NoReturn, Sequence

import numpy as np

from . import _native
from ._columns import Columns, allocated, checked_every, periods_of, spread, spread_counts, time_axis
from ._joint import JointLike
from ._plants import flat, joints_of, with_joints
from ._process import claim

QUANTITIES = _native.CONTROLLER_COLUMNS
"""Recorded quantities of a controller: names, and types of numpy. Codes: `stage` 0 touching, 1 crossing, 2 landing,
3 plain control, 4 off, 5 reversed; `contact` and `flank` 0 separated, 1 drive side, 2 back side; `source` encoders in
use."""
OF_COMPENSATION = ("torque_N_m", "trust", "demand_N_m", "stage", "flank", "short_of_torque", "stepped_back")
"""Quantities that an observer alone does not have."""
USUAL = ("torque_N_m", "stage", "gap_m", "gap_valid", "half_backlash_m", "load_torque_N_m")
"""Quantities that many controllers record by default."""
USUAL_OF_OBSERVERS = ("gap_m", "gap_valid", "half_backlash_m", "half_backlash_valid", "load_torque_N_m", "contact")
"""Quantities that many observers record by default."""

SetPointArrays = tuple["np.ndarray[Any, Any] | None", list["np.ndarray[Any, Any]"]]


@dataclass(eq=False)
class Motion:
    """Motion that the links follow; arrays of the shape (periods, n), or (periods,) for all alike.

    Attributes:
        position: link angles [rad].
        speed: [rad/s]; difference quotients of the position if left out.
        acceleration: [rad/s^2]; difference quotients of the speed if left out.
    """

    position: Any
    speed: Any = None
    acceleration: Any = None

    def arrays(self, periods: int, n: int, rate: int) -> SetPointArrays:
        """Arrays of the compiled half."""
        speed = _slope(self.position, rate) if self.speed is None else self.speed
        acceleration = _slope(speed, rate) if self.acceleration is None else self.acceleration
        rest = {"speed": speed, "acceleration": acceleration}
        return _spread_set_point(self.position, rest, periods, n)


def _slope(values: Any, rate: int) -> "np.ndarray[Any, Any]":
    """Difference quotients over the rows; zero without a second row."""
    array = np.asarray(values, dtype=np.float64)
    return np.gradient(array, axis=0) * rate if array.ndim > 0 and len(array) > 1 else np.zeros_like(array)


@dataclass(eq=False)
class Impedance:
    """Springs and dampers about moving points; numbers, or arrays of the shape (periods, n) or (periods,).

    Attributes:
        position: link angles at which the springs are relaxed [rad].
        stiffness: [N m/rad].
        damping: [N m s/rad].
        speed: speed of the points [rad/s].
        torque: torque on top of spring and damper [N m].
    """

    position: Any
    stiffness: Any
    damping: Any
    speed: Any = 0.0
    torque: Any = 0.0

    def arrays(self, periods: int, n: int, rate: int) -> SetPointArrays:
        """Arrays of the compiled half."""
        rest = {"speed": self.speed, "torque": self.torque, "stiffness": self.stiffness, "damping": self.damping}
        return _spread_set_point(self.position, rest, periods, n)


def _spread_set_point(position: Any, rest: Mapping[str, Any], periods: int, n: int) -> SetPointArrays:
    angle = spread("set-point's position", position, np.float64, periods, n)
    return angle, [spread(f"set-point's {name}", it, np.float32, periods, n) for name, it in rest.items()]


def named(set_point: "Motion | Impedance | None") -> dict[str, Any]:
    """Arrays of a set-point as passed by the caller, by name."""
    values = {} if set_point is None else vars(set_point)
    return {f"set-point's {name}": value for name, value in values.items() if value is not None}


def arrays_of(set_point: "Motion | Impedance | None", periods: int, n: int, rate: int) -> SetPointArrays:
    """Arrays of a set-point; without one angle zero is held."""
    return (None, []) if set_point is None else set_point.arrays(periods, n, rate)


class Controllers:
    """Controllers of many joints: an observer and a compensation each, as on the board.

    Args:
        joint: one joint for all, or a sequence with a joint each: the joint as told to the controller, whose backlash may
            be a guess.
        n: number of controllers; may be left out for a sequence.
        rate: control rate [Hz]; the joint file's if left out.
        bandwidth: bandwidth of the loop [rad/s]; 60, or as much as the joint allows, if left out.
        output_encoder: False designs the observer without the output's encoder.

    Raises:
        JointError: if no controller can be designed for the joint.
    """

    native: _native.Controllers
    has_compensation = True

    def __init__(
        self,
        joint: "JointLike | Sequence[JointLike]",
        n: int | None = None,
        *,
        rate: int | None = None,
        bandwidth: float | None = None,
        output_encoder: bool = True,
    ) -> None:
        claim()
        joints, count = joints_of(joint, n)
        self.native = _native.Controllers(joints, count, rate, bandwidth, output_encoder, self.has_compensation)

    def __len__(self) -> int:
        return len(self.native)

    @property
    def rate_Hz(self) -> int:
        """Control rate [Hz]."""
        return self.native.rate

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        raise TypeError(
            "a controller is not copied or pickled: make a new one of the same joint, and give it the estimated parameters "
            "by new.load(old.save())"
        )

    @property
    def lead_s(self) -> Any:
        """Times by which motions are read ahead [s]: shape (n,), or a number for a `Controller`."""
        if not self.has_compensation:
            raise AttributeError("an observer follows no motion: lead_s is a quantity of controllers")
        return np.array(self.native.leads)

    def step(
        self,
        motor_counts: Any,
        output_counts: Any,
        torque: Any,
        set_point: Motion | Impedance | None = None,
        *,
        preview: bool = True,
        every: int = 1,
        record: Sequence[str] | None = USUAL,
        out: Mapping[str, "np.ndarray[Any, Any]"] | None = None,
    ) -> Columns:
        """Runs a control period per row over recorded or computed samples.

        Args:
            motor_counts: counts of the motors' encoders within their turn, uint32, shape (periods, n) or (periods,).
            output_counts: counts of the outputs' encoders, or None for no reading; NaN is no reading in that period.
            torque: torques commanded in the periods before [N m], of the same shape.
            set_point: `Motion` or `Impedance`; angle zero is held if left out.
            preview: True reads each joint's motion ahead by its `lead_s`. In the last `lead_s` of the array the motion
                ahead is unknown: a motion that is passed in several calls is not read ahead from one call into the next.
            every: periods per recorded row.
            record: names of the recorded quantities; None records all.
            out: arrays of the shape (periods // every, n) to be filled in place, by name.

        Returns:
            Arrays of the shape (periods // every, n): row i has the outputs of period (i + 1) * every.
        """
        claim()
        given = {"motor_counts": motor_counts, "torque": torque, **named(set_point)}
        periods = periods_of(given if output_counts is None else {"output_counts": output_counts, **given}, None)
        n, every = len(self), checked_every(every)
        position, rest = arrays_of(set_point, periods, n, self.rate_Hz)
        motor, _ = spread_counts("motor_counts", motor_counts, periods, n)
        counts, missing = (
            (None, None)
            if output_counts is None
            else spread_counts("output_counts", output_counts, periods, n, gaps=True)
        )
        torque = spread("torque", torque, np.float32, periods, n)
        inputs = [motor, counts, torque, position, *rest]
        arrays = allocated(QUANTITIES, record if out is None else None, out, (periods // every, n), inputs)
        self.native.step(motor, counts, missing, torque, position, rest, preview, every, arrays)
        return Columns(dict(arrays), time_axis(periods, every, self.rate_Hz))

    def reset(self) -> None:
        """Returns every controller to its designed state; estimated parameters are lost."""
        self.native.reset()

    def save(self, index: int = 0) -> bytes:
        """Estimated parameters of a joint, in the form that boards and C programs load."""
        return self.native.save(index)

    def load(self, memory: bytes, index: int = 0) -> None:
        """Restores saved parameters of a joint; a refused memory changes nothing."""
        self.native.load(index, memory)


class Observers(Controllers):
    """Observers of many joints: estimates of gap, backlash, contact and torques, without a compensation.

    Arguments as for `Controllers`, without the bandwidth, which is the compensation's.
    """

    has_compensation = False

    def __init__(
        self,
        joint: "JointLike | Sequence[JointLike]",
        n: int | None = None,
        *,
        rate: int | None = None,
        output_encoder: bool = True,
    ) -> None:
        super().__init__(joint, n, rate=rate, output_encoder=output_encoder)

    def step(  # type: ignore[override]
        self,
        motor_counts: Any,
        output_counts: Any,
        torque: Any,
        *,
        every: int = 1,
        record: Sequence[str] | None = USUAL_OF_OBSERVERS,
        out: Mapping[str, "np.ndarray[Any, Any]"] | None = None,
    ) -> Columns:
        """Runs a control period per row over samples; arguments and result as in `Controllers.step`."""
        if record is None and out is None:
            record = tuple(name for name, _ in QUANTITIES if name not in OF_COMPENSATION)
        for name in (record if out is None else out) or ():
            if name in OF_COMPENSATION:
                raise KeyError(f"{name!r} is a quantity of controllers: an observer does not have it")
        return super().step(motor_counts, output_counts, torque, None, every=every, record=record, out=out)


class Controller(Controllers):
    """Controller of one joint: as `Controllers`, with arrays of the shape (periods,)."""

    def __init__(
        self,
        joint: JointLike,
        *,
        rate: int | None = None,
        bandwidth: float | None = None,
        output_encoder: bool = True,
    ) -> None:
        super().__init__(joint, 1, rate=rate, bandwidth=bandwidth, output_encoder=output_encoder)

    @property
    def lead_s(self) -> float:
        """Time by which a motion is read ahead [s]."""
        return self.native.leads[0]

    def step(
        self,
        motor_counts: Any,
        output_counts: Any,
        torque: Any,
        set_point: Motion | Impedance | None = None,
        *,
        preview: bool = True,
        every: int = 1,
        record: Sequence[str] | None = None,
        out: Mapping[str, "np.ndarray[Any, Any]"] | None = None,
    ) -> Columns:
        """Runs a control period per element; arguments as in `Controllers.step`, arrays of the shape (periods,)."""
        return flat(
            super().step(
                motor_counts, output_counts, torque, set_point, preview=preview, every=every, record=record, out=with_joints(out)
            )
        )


class Observer(Observers):
    """Observer of one joint: as `Observers`, with arrays of the shape (periods,)."""

    def __init__(self, joint: JointLike, *, rate: int | None = None, output_encoder: bool = True) -> None:
        super().__init__(joint, 1, rate=rate, output_encoder=output_encoder)

    def step(  # type: ignore[override]
        self,
        motor_counts: Any,
        output_counts: Any,
        torque: Any,
        *,
        every: int = 1,
        record: Sequence[str] | None = None,
        out: Mapping[str, "np.ndarray[Any, Any]"] | None = None,
    ) -> Columns:
        """Runs a control period per element; arguments as in `Controllers.step`, arrays of the shape (periods,)."""
        return flat(super().step(motor_counts, output_counts, torque, every=every, record=record, out=with_joints(out)))
