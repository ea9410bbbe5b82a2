"""Plants: arrays, bits, cores, Ctrl-C."""

import _thread
import ctypes
import json
import os
import platform
import threading
import time
import tracemalloc

import numpy as np
import pytest

from lostmotion import Joint, Plant, Plants

BITS = json.loads(open(os.environ["LOSTMOTION_BITS"]).read())


def torques(periods):
    """Torque command and load of each period, as in the Rust half of this test."""
    period = np.arange(periods)
    sign = lambda half: np.where(period // half % 2 == 0, 1.0, -1.0)
    return (0.25 * sign(700)).astype(np.float32), sign(1100).astype(np.float32)


@pytest.mark.parametrize("name", BITS["joints"])
def test_plant_has_the_bits_of_the_core(name):
    torque, load = torques(BITS["periods"])
    plants = Plants(name, n=3)
    plants.step(torque, load, record=())
    assert plants.digests().tolist() == [BITS["joints"][name]["plant"]] * 3
    # Header of the tables: mark, version, size, digest.
    assert int.from_bytes(plants.tables()[16:24], "little") == BITS["joints"][name]["tables"]


def test_rounding_of_other_modules_changes_no_bit():
    torque, load = torques(3000)
    expected, other = Plant("q1"), None
    expected.step(torque, load, record=())
    libm = ctypes.CDLL("libm.so.6")
    upward = {"x86_64": 0x800, "aarch64": 0x400000}[platform.machine()]
    libm.fesetround(upward)
    try:
        other = Plant("q1")
        other.step(torque, load, record=())
        mode = libm.fegetround()
    finally:
        libm.fesetround(0)
    assert mode == upward, "the mode of the caller stays"
    assert other.digests() == expected.digests()


def test_recording_changes_no_bit():
    torque, load = torques(3000)
    silent, recorded = Plant("q1"), Plant("q1")
    silent.step(torque, load, record=())
    columns = recorded.step(torque, load)
    assert silent.digests() == recorded.digests()
    assert all(values.shape == (3000,) for values in columns.values())
    assert columns.time_s[0] == pytest.approx(1e-4) and columns["gap_m"].dtype == np.float32
    gap = columns["gap_m"]
    assert gap.max() > 4e-5 and gap.min() < -4e-5, "the torque pushes the teeth across the gap"


def test_calls_continue_one_another():
    torque, load = torques(3000)
    whole, parts = Plant("q1"), Plant("q1")
    expected = whole.step(torque, load, every=10)
    first = parts.step(torque[:1000], load[:1000], every=10)
    second = parts.step(torque[1000:], load[1000:], every=10)
    for name, values in expected.items():
        assert np.array_equal(values, np.concatenate([first[name], second[name]])), name
    state = parts.state()
    assert state["link_angle_rad"][0] == expected["link_angle_rad"][-1]


def test_each_plant_has_its_own_torque_and_joint():
    joints = [Joint("q1"), Joint("c1"), Joint("q1", {"half_backlash_um": 80})] * 20
    torque, load = torques(2000)
    each = torque[:, np.newaxis] * np.linspace(0.5, 1.0, len(joints), dtype=np.float32)
    plants = Plants(joints, rate=10_000)
    columns = plants.step(each, load, record=["link_angle_rad", "motor_counts"], every=100)
    assert columns["motor_counts"].shape == (20, 60) and columns["motor_counts"].dtype == np.uint32
    for index in (0, 1, 2, 31, 59):
        alone = Plant(joints[index], rate=10_000)
        expected = alone.step(each[:, index].copy(), load, record=["link_angle_rad"], every=100)
        assert np.array_equal(columns["link_angle_rad"][:, index], expected["link_angle_rad"])
        assert alone.digests()[0] == plants.digests()[index]


def test_arrays_are_used_in_place():
    torque, _ = torques(1000)
    out = {"gap_m": np.full((100, 4), np.nan, dtype=np.float32)}
    columns = Plants("q1", n=4).step(torque, every=10, out=out)
    assert columns["gap_m"] is out["gap_m"] and np.isfinite(out["gap_m"]).all()
    # A slice of a larger array, with strides.
    large = np.zeros((100, 8), dtype=np.float32)
    Plants("q1", n=4).step(torque, every=10, out={"gap_m": large[:, ::2]})
    assert np.array_equal(large[:, ::2], out["gap_m"]) and not large[:, 1::2].any()
    with pytest.raises(ValueError, match="float32"):
        Plants("q1", n=4).step(torque, every=10, out={"gap_m": np.zeros((100, 4))})
    with pytest.raises(ValueError, match="shape"):
        Plants("q1", n=4).step(torque, every=10, out={"gap_m": np.zeros((99, 4), dtype=np.float32)})


def test_inputs_are_not_copied_for_each_plant():
    """A copy for each of 4000 plants would be 160 MB."""
    torque, plants = np.full(10_000, 0.1, dtype=np.float32), Plants("q1", n=4000)
    threading.Timer(1.0, _thread.interrupt_main).start()
    tracemalloc.start()
    with pytest.raises(KeyboardInterrupt):
        plants.step(torque, np.zeros(10_000, dtype=np.float32), record=())
    largest = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert largest < 10e6, f"{largest / 1e6:.1f} MB"


def test_reset_returns_to_rest():
    plants = Plants("q1", n=2)
    fresh = plants.digests()
    plants.step(0.3, steps=500)
    assert (plants.digests() != fresh).all()
    plants.reset()
    assert (plants.digests() == fresh).all()


def test_wrong_arguments_are_named():
    plants = Plants("q1", n=4)
    with pytest.raises(KeyError, match="gap_mm"):
        plants.step(0.1, steps=10, record=["gap_mm"])
    with pytest.raises(ValueError, match="steps="):
        plants.step(0.1)
    with pytest.raises(ValueError, match=r"torque has the shape \(10, 3\)"):
        plants.step(np.zeros((10, 3), dtype=np.float32))
    with pytest.raises(ValueError, match="every"):
        plants.step(0.1, steps=10, every=0)
    with pytest.raises(ValueError, match="3 joints are wanted"):
        Plants([Joint("q1"), Joint("c1")], n=3)


def test_other_threads_run_meanwhile():
    plants, ticks = Plants("q1", n=64), []
    done = threading.Event()

    def count():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    plants.step(0.1, steps=20_000, record=())
    done.set()
    thread.join()
    assert len(ticks) > 20, "the lock was held"


def test_ctrl_c_ends_a_long_run():
    plants = Plants("q1", n=1000)
    threading.Timer(0.3, _thread.interrupt_main).start()
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        plants.step(0.1, steps=10_000_000, record=())
    assert time.monotonic() - begin < 5
    plants.step(0.1, steps=10)


def test_thousands_of_plants_on_all_cores():
    periods, n = 1000, 4000
    plants = Plants("q1", n=n)
    torque = np.full(periods, 0.1, dtype=np.float32)
    begin = time.monotonic()
    plants.step(torque, every=10)
    seconds = time.monotonic() - begin
    print(f"\n{n} plants of Q1 on {os.cpu_count()} cores: {periods * n / seconds / 1e6:.2f} million steps a second")
    alone = Plant("q1")
    alone.step(torque, record=())
    assert set(plants.digests().tolist()) == set(alone.digests().tolist())
