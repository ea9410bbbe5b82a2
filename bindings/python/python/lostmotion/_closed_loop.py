"""Plants under their controllers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Sequence

import numpy as np

from . import _native, _controllers, _plants
from ._columns import Columns, allocated, checked_every, periods_of, spread, time_axis
from ._controllers import Controllers, Impedance, Motion
from ._plants import Plant, Plants, flat
from ._process import claim


@dataclass
class ClosedLoop:
    """Columns of a closed loop.

    Attributes:
        plant: true motion after each recorded period.
        controller: outputs of observer and compensation in that period.
    """

    plant: Columns
    controller: Columns


def closed_loop(
    plants: Plants,
    controllers: Controllers,
    set_point: Motion | Impedance | None = None,
    load: Any = 0.0,
    *,
    steps: int | None = None,
    preview: bool = True,
    every: int = 1,
    record: Sequence[str] | None = _plants.USUAL,
    record_controllers: Sequence[str] | None = _controllers.USUAL,
) -> ClosedLoop:
    """Runs plants under controllers, a control period per row, on all cores without Python's lock.

    Args:
        plants: `Plants`, or a `Plant`; they go on from their present state.
        controllers: `Controllers` of the same number, or a `Controller`, at the same control rate.
        set_point: `Motion` or `Impedance` with arrays of the shape (periods, n) or (periods,); angle zero is held if left
            out.
        load: torques that brake the links [N m], of the same shapes.
        steps: number of periods, if nothing is an array.
        preview: True reads each joint's motion ahead by its `controllers.lead_s`. In the last `lead_s` of the array the
            motion ahead is unknown.
        every: periods per recorded row.
        record: names of the plants' recorded quantities; None records all.
        record_controllers: names of the controllers' recorded quantities; None records all.

    Returns:
        Arrays of the shape (periods // every, n), or (periods // every,) for a `Plant`.
    """
    if plants.rate_Hz != controllers.rate_Hz:
        raise ValueError(f"the plants run at {plants.rate_Hz} Hz and the controllers at {controllers.rate_Hz} Hz")
    if not controllers.has_compensation:
        raise ValueError("an observer commands no torque: pass a Controller")
    if len(plants) != len(controllers):
        raise ValueError(f"{len(plants)} plants and {len(controllers)} controllers")
    claim()
    n, every = len(plants), checked_every(every)
    periods = periods_of({**_controllers.named(set_point), "load": load}, steps)
    angle, rest = _controllers.arrays_of(set_point, periods, n, plants.rate_Hz)
    shape = (periods // every, n)
    of_plants = allocated(_plants.QUANTITIES, record, None, shape)
    of_controllers = allocated(_controllers.QUANTITIES, record_controllers, None, shape)
    load = spread("load", load, np.float32, periods, n)
    _native.run(plants.native, controllers.native, angle, rest, load, preview, every, of_plants, of_controllers)
    time = time_axis(periods, every, plants.rate_Hz)
    columns = [Columns(dict(of_plants), time), Columns(dict(of_controllers), time)]
    if isinstance(plants, Plant):
        columns = [flat(it) for it in columns]
    return ClosedLoop(*columns)
