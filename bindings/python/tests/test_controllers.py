"""Observer, compensation and the closed loop."""

import json
import os
import time

import numpy as np
import pytest

from lostmotion import (
    Controller,
    Controllers,
    Impedance,
    Joint,
    JointError,
    Motion,
    Observer,
    Observers,
    Plant,
    Plants,
    closed_loop,
)

BITS = json.loads(open(os.environ["LOSTMOTION_BITS"]).read())
RATE = 10_000


def chained(values):
    """Digest of the core: `model_core::numbers::digest::chain` over the bits of float32 numbers."""
    mask, running = 2**64 - 1, 0x6A6F696E742D3031
    for word in values.view(np.uint32).tolist():
        rotated = (running << 5 | running >> 59) & mask
        running = (rotated ^ word) * 0x9e37_79b9_7f4a_7c15 & mask
    return running


def reversals(seconds, amplitude=0.3, frequency=2.0):
    """Motion that inertia drives across the gap at each reversal; at half the rate gravity holds one flank."""
    time_s = np.arange(int(seconds * RATE)) / RATE
    return amplitude * (1 - np.cos(2 * np.pi * frequency * time_s))


@pytest.mark.parametrize("name", BITS["joints"])
def test_closed_loop_has_the_bits_of_the_core(name):
    period = np.arange(BITS["periods"])
    load = np.where(period // 1100 % 2 == 0, 1.0, -1.0).astype(np.float32)
    # A motion to and fro, with the operations in the order of the Rust half.
    phase = period % 2000 / 2000
    rest = 1.0 - phase
    position = 0.48 * phase * phase * rest * rest
    speed = 4.8 * phase * rest * (rest - phase)
    acceleration = 24.0 * (rest * rest - 4.0 * phase * rest + phase * phase)
    loop = closed_loop(Plant(name), Controller(name), Motion(position, speed, acceleration), load)
    torque = np.ascontiguousarray(loop.controller["torque_N_m"])
    assert chained(torque) == BITS["joints"][name]["controller"]


def test_compensation_finds_the_gap_and_follows():
    truth = Joint("q1")
    told = truth.changed({"half_backlash_um": 60})
    loop = closed_loop(Plant(truth), Controller(told), Motion(reversals(4)), record_controllers=None)
    found, valid = loop.controller["half_backlash_m"], loop.controller["half_backlash_valid"]
    assert valid[-1] and found[-1] == pytest.approx(40e-6, rel=0.1), "told 60 um, found the true width"
    error = loop.plant["link_angle_rad"][-2 * RATE :] - reversals(4)[-2 * RATE :]
    assert np.sqrt(np.mean(error**2)) < 1e-3


def test_observer_sees_what_the_controller_sees():
    plant, controller = Plant("q1"), Controller("q1")
    position = reversals(2)
    loop = closed_loop(plant, controller, Motion(position), record=None, record_controllers=None)
    # Counts and torque before each period: the state after the period before it.
    start = Plant("q1").state(["motor_counts", "output_counts"])
    before = {name: np.concatenate([start[name], loop.plant[name][:-1]]) for name in start}
    torque = np.concatenate([[0.0], loop.controller["torque_N_m"][:-1]]).astype(np.float32)
    seen = Observer("q1").step(before["motor_counts"], before["output_counts"], torque)
    for name, values in seen.items():
        assert np.array_equal(values, loop.controller[name]), name
    same = Controller("q1").step(before["motor_counts"], before["output_counts"], torque, Motion(position))
    assert np.array_equal(same["torque_N_m"], loop.controller["torque_N_m"])
    assert "torque_N_m" not in seen


def test_many_loops_equal_single_ones():
    widths = np.linspace(20, 80, 20)
    joints = [Joint("q1", {"half_backlash_um": float(width)}) for width in widths]
    position = reversals(0.5)
    loop = closed_loop(Plants(joints), Controllers("q1", n=20), Motion(position), every=10)
    assert loop.plant["gap_m"].shape == (500, 20)
    for index in (0, 17):
        alone = closed_loop(Plant(joints[index]), Controller("q1"), Motion(position), every=10)
        assert np.array_equal(loop.plant["gap_m"][:, index], alone.plant["gap_m"])


def test_impedance_gives_way():
    joint = Joint("q1", {"gravity_torque_N_m": 0})
    loop = closed_loop(Plant(joint), Controller(joint), Impedance(0.0, 100.0, 4.0), 2.0, steps=RATE)
    assert -0.024 < loop.plant["link_angle_rad"][-1] < -0.013


def test_saved_parameters_are_restored():
    controllers = Controllers("q1", n=2)
    closed_loop(Plants("q1", n=2), controllers, Motion(reversals(4)), every=1000)
    memory = controllers.save()
    fresh = Controller("q1")
    fresh.load(memory)
    assert len(memory) == 544
    with pytest.raises(JointError, match="memory"):
        fresh.load(b"nothing")
    with pytest.raises(JointError, match="another joint"):
        Controller("c1").load(memory)
    with pytest.raises(IndexError):
        controllers.save(2)


def test_missing_readings_are_allowed():
    counts = np.zeros(1000, dtype=np.uint32)
    seen = Observers("q1", n=3).step(counts, None, 0.0, record=["source", "gap_valid"])
    assert seen["source"].shape == (1000, 3) and not seen["gap_valid"].any()


def test_mismatches_are_named():
    with pytest.raises(ValueError, match="Hz"):
        closed_loop(Plant("q1", rate=20_000), Controller("q1"), steps=10)
    with pytest.raises(ValueError, match="2 plants"):
        closed_loop(Plants("q1", n=2), Controllers("q1", n=3), steps=10)
    with pytest.raises(ValueError, match="observer"):
        closed_loop(Plant("q1"), Observer("q1"), steps=10)


def test_interrupted_controller_goes_on_with_its_own_clock():
    """A controller that has seen 500 periods meets plants at time zero: its clock goes on, and it sees no jump."""
    used, rows = Controller("q1"), 500
    start = Plant("q1").state(["motor_counts", "output_counts"])
    still = [np.full(rows, start[name][0]) for name in ("motor_counts", "output_counts")]
    used.step(*still, 0.0, record=())
    loop = closed_loop(Plant("q1"), used, steps=100, record=None, record_controllers=None)
    assert (loop.controller["source"] == 2).all()
    whole = Controller("q1")
    whole.step(*still, 0.0, record=())
    before = {name: np.concatenate([start[name], loop.plant[name][:-1]]) for name in start}
    torque = np.concatenate([[0.0], loop.controller["torque_N_m"][:-1]])
    same = whole.step(before["motor_counts"], before["output_counts"], torque)
    for name, values in same.items():
        assert np.array_equal(values, loop.controller[name]), name


def test_motion_ahead_ends_with_the_array():
    """Near its end a motion is as unknown ahead as without a preview."""
    position = reversals(0.3)
    lead = round(Controller("q1").lead_s * RATE)
    assert lead > 1
    ends, goes_on = Controller("q1"), Controller("q1")
    known = len(position) - lead
    counts = np.zeros(len(position), dtype=np.uint32)
    motion = Motion(position, np.gradient(position) * RATE, np.zeros_like(position))
    cut = Motion(*(values[:-10] for values in (motion.position, motion.speed, motion.acceleration)))
    whole = goes_on.step(counts, counts, 0.0, motion)
    part = ends.step(counts[:-10], counts[:-10], 0.0, cut)
    assert np.array_equal(part["torque_N_m"][: known - 10], whole["torque_N_m"][: known - 10])


def test_thousand_loops_on_all_cores():
    n, periods = 1000, 1000
    plants, controllers = Plants("q1", n=n), Controllers("q1", n=n)
    begin = time.monotonic()
    loop = closed_loop(plants, controllers, Motion(reversals(0.1)), every=10)
    seconds = time.monotonic() - begin
    print(f"\n{n} closed loops on {os.cpu_count()} cores: {n * periods / seconds / 1e6:.2f} million periods a second")
    alone = closed_loop(Plant("q1"), Controller("q1"), Motion(reversals(0.1)), every=10)
    assert (loop.controller["torque_N_m"] == alone.controller["torque_N_m"][:, np.newaxis]).all()
    assert (loop.plant["link_angle_rad"][-1] == alone.plant["link_angle_rad"][-1]).all()
