"""Observers and controllers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Sequence

import numpy as np

from . import _native
from ._columns import Columns, allocated, periods_of, spread, time_axis
from ._joint import Joint
from ._plants import flat, joints_of

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


@dataclass
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
        position = np.asarray(self.position, dtype=np.float64)
        slope = (lambda of: np.gradient(of, axis=0) * rate) if np.ndim(position) > 0 and len(position) > 1 else np.zeros_like
        speed = slope(position) if self.speed is None else np.asarray(self.speed)
        acceleration = slope(speed) if self.acceleration is None and np.ndim(speed) > 0 else self.acceleration
        rest = [speed, 0.0 if acceleration is None else acceleration]
        return spread(position, np.float64, periods, n), [spread(it, np.float32, periods, n) for it in rest]


@dataclass
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
        rest = [self.speed, self.torque, self.stiffness, self.damping]
        return spread(self.position, np.float64, periods, n), [spread(it, np.float32, periods, n) for it in rest]


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
        joint: "Joint | str | Sequence[Joint | str]",
        n: int | None = None,
        *,
        rate: int | None = None,
        bandwidth: float | None = None,
        output_encoder: bool = True,
    ) -> None:
        joints, count = joints_of(joint, n)
        self.native = _native.Controllers(joints, count, rate, bandwidth, output_encoder, self.has_compensation)

    def __len__(self) -> int:
        return len(self.native)

    @property
    def rate_Hz(self) -> int:
        """Control rate [Hz]."""
        return self.native.rate

    @property
    def lead_s(self) -> float:
        """Time by which a motion is read ahead if it is known [s]."""
        return self.native.lead

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
            output_counts: counts of the outputs' encoders, or None for no reading.
            torque: torques commanded in the periods before [N m], of the same shape.
            set_point: `Motion` or `Impedance`; angle zero is held if left out.
            preview: True reads a motion ahead by `lead_s`, as far as the array goes.
            every: periods per recorded row.
            record: names of the recorded quantities; None records all.
            out: arrays of the shape (periods // every, n) to be filled in place, by name.

        Returns:
            Arrays of the shape (periods // every, n): row i has the outputs of period (i + 1) * every.
        """
        periods, n = periods_of([motor_counts], None), len(self)
        if every < 1:
            raise ValueError("every must be 1 or more")
        position, rest = arrays_of(set_point, periods, n, self.rate_Hz)
        arrays = allocated(QUANTITIES, record if out is None else None, out, (periods // every, n))
        counts = None if output_counts is None else spread(output_counts, np.uint32, periods, n)
        motor, torque = spread(motor_counts, np.uint32, periods, n), spread(torque, np.float32, periods, n)
        self.native.step(motor, counts, torque, position, rest, preview, every, arrays)
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

    Arguments as for `Controllers`.
    """

    has_compensation = False

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
        return super().step(motor_counts, output_counts, torque, None, every=every, record=record, out=out)


class Controller(Controllers):
    """Controller of one joint: as `Controllers`, with arrays of the shape (periods,)."""

    def __init__(
        self,
        joint: Joint | str,
        *,
        rate: int | None = None,
        bandwidth: float | None = None,
        output_encoder: bool = True,
    ) -> None:
        super().__init__(joint, 1, rate=rate, bandwidth=bandwidth, output_encoder=output_encoder)

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
        filled = None if out is None else {name: values[:, np.newaxis] for name, values in out.items()}
        return flat(
            super().step(
                motor_counts, output_counts, torque, set_point, preview=preview, every=every, record=record, out=filled
            )
        )


class Observer(Observers):
    """Observer of one joint: as `Observers`, with arrays of the shape (periods,)."""

    def __init__(self, joint: Joint | str, *, rate: int | None = None, output_encoder: bool = True) -> None:
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
        filled = None if out is None else {name: values[:, np.newaxis] for name, values in out.items()}
        return flat(super().step(motor_counts, output_counts, torque, every=every, record=record, out=filled))
