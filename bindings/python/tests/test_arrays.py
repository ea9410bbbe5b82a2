"""Arrays: addresses, overlaps, finite numbers, lengths."""

import numpy as np
import pytest

from lostmotion import Controller, Controllers, Impedance, Motion, Observer, Observers, Plant, Plants, closed_loop


def packed(values, kind):
    """Field of a packed record, at odd addresses."""
    records = np.zeros(values.shape, dtype=np.dtype([("flag", "u1"), ("value", kind)]))
    records["value"] = values
    return records["value"]


def torques(periods=200, n=4):
    return np.linspace(-0.3, 0.3, periods * n, dtype=np.float32).reshape(periods, n)


def test_packed_torque_is_read_like_a_plain_one():
    plain, odd = Plants("q1", n=4), Plants("q1", n=4)
    plain.step(torques(), record=())
    assert not packed(torques(), "f4").flags.aligned
    odd.step(packed(torques(), "f4"), packed(np.zeros((200, 4)), "f4"), record=())
    assert (plain.digests() == odd.digests()).all()
    swapped = Plants("q1", n=4)
    swapped.step(torques().astype(">f4"), record=())
    assert (plain.digests() == swapped.digests()).all()


def test_packed_counts_and_set_points_are_read_like_plain_ones():
    counts = np.arange(0, 2000, 10, dtype=np.uint32)
    position = np.linspace(0, 0.1, 200)
    plain = Controller("q1").step(counts, counts, 0.0, Motion(position))
    odd = Controller("q1").step(packed(counts, "u4"), packed(counts, "u4"), 0.0, Motion(packed(position, "f8")))
    for name, values in plain.items():
        assert np.array_equal(values, odd[name], equal_nan=True), name


READ_ONLY = np.zeros((20, 4), dtype=np.float32)
READ_ONLY.flags.writeable = False


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (packed(np.zeros((20, 4)), "f4"), "not aligned"),
        (READ_ONLY, "not writeable"),
        (np.zeros((20, 4)), "type <f8"),
        (np.zeros((20, 4), dtype=">f4"), "type >f4"),
        (np.lib.stride_tricks.as_strided(np.zeros(20, dtype=np.float32), (20, 4), (4, 0)), "overlaps itself"),
        (np.lib.stride_tricks.as_strided(np.zeros(24, dtype=np.float32), (20, 4), (4, 4)), "overlaps itself"),
        (np.zeros((19, 4), dtype=np.float32), "shape"),
    ],
    ids=["packed", "read-only", "type", "byte-order", "stride-zero", "strides", "shape"],
)
def test_unusable_output_is_refused_by_name(array, message):
    with pytest.raises(ValueError, match=message) as refused:
        Plants("q1", n=4).step(torques(), every=10, out={"gap_m": array})
    assert "gap_m" in str(refused.value)


def test_overlapping_arrays_are_refused_by_name():
    large = np.zeros((200, 8), dtype=np.float32)
    with pytest.raises(ValueError, match="'wind_up_m'.*'gap_m'"):
        Plants("q1", n=4).step(torques(), out={"gap_m": large[:, :4], "wind_up_m": large[:, 3:7]})
    with pytest.raises(ValueError, match="'gap_m'.*input"):
        Plants("q1", n=4).step(large[:, :4], out={"gap_m": large[:, :4]})
    Plants("q1", n=4).step(torques(), out={"gap_m": large[:, ::2], "wind_up_m": large[:, 1::2]})
    assert large.any(axis=0).all(), "interleaved columns share no element"


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e39])
def test_number_that_is_not_finite_is_refused_with_name_and_row(bad):
    torque = np.zeros((100, 2))
    torque[70, 1] = bad
    with pytest.raises(ValueError, match="torque .*row 70 and joint 1"):
        Plants("q1", n=2).step(torque)
    with pytest.raises(ValueError, match="load .*row 70"):
        Plant("q1").step(0.0, torque[:, 1])
    with pytest.raises(ValueError, match="position .*row 70") if bad != 1e39 else pytest.raises(ValueError):
        closed_loop(Plant("q1"), Controller("q1"), Motion(torque[:, 1]))
    with pytest.raises(ValueError, match="stiffness"):
        closed_loop(Plant("q1"), Controller("q1"), Impedance(0.0, bad, 1.0), steps=10)
    with pytest.raises(ValueError, match="torque .*row 70"):
        Observers("q1", n=2).step(np.zeros(100, dtype=np.uint32), None, torque)


def test_number_that_is_no_count_is_refused_with_name_and_row():
    for bad in (-1, 2**32, 0.5, np.nan, np.inf):
        counts = np.zeros(50, dtype=np.float64)
        counts[30] = bad
        with pytest.raises(ValueError, match="motor_counts .*row 30"):
            Observer("q1").step(counts, None, 0.0)
    with pytest.raises(ValueError, match="motor_counts .*row 1"):
        Observer("q1").step(np.array([0, -5]), None, 0.0)
    with pytest.raises(TypeError, match="motor_counts"):
        Observer("q1").step(np.array(["a"]), None, 0.0)


def test_nan_in_output_counts_is_no_reading():
    counts = np.zeros(100, dtype=np.uint32)
    output = np.zeros(100)
    output[50:] = np.nan
    seen = Observer("q1").step(counts, output, 0.0, record=["source", "gap_m", "load_torque_N_m"])
    whole, none = Observer("q1"), Observer("q1")
    first = whole.step(counts[:50], counts[:50], 0.0, record=["source", "gap_m", "load_torque_N_m"])
    last = whole.step(counts[:50], None, 0.0, record=["source", "gap_m", "load_torque_N_m"])
    for name, values in seen.items():
        assert np.array_equal(values, np.concatenate([first[name], last[name]])), name
    assert (none.step(counts, None, 0.0)["source"] != 2).all() and seen["source"][0] == 2


def test_different_numbers_of_periods_are_named():
    with pytest.raises(ValueError, match="torque 10, load 12"):
        Plant("q1").step(np.zeros(10), np.zeros(12))
    with pytest.raises(ValueError, match="torque 10, steps 11"):
        Plant("q1").step(np.zeros(10), steps=11)
    with pytest.raises(ValueError, match="output_counts 9, motor_counts 10"):
        Observer("q1").step(np.zeros(10, dtype=np.uint32), np.zeros(9, dtype=np.uint32), 0.0)
    with pytest.raises(ValueError, match="position 10, set-point's speed 11"):
        closed_loop(Plant("q1"), Controller("q1"), Motion(np.zeros(10), np.zeros(11)))
    with pytest.raises(ValueError, match=r"torque has the shape \(10, 3\)"):
        Plants("q1", n=4).step(np.zeros((10, 3)))
    # Whichever array has rows gives their number.
    loop = closed_loop(Plant("q1"), Controller("q1"), Impedance(0.0, np.full(25, 10.0), 1.0))
    assert loop.plant["gap_m"].shape == (25,)
    assert Plants("q1", n=3).step(np.zeros((1, 3)), steps=5)["gap_m"].shape == (5, 3)


def test_observers_refuse_what_they_do_not_have():
    counts = np.zeros(10, dtype=np.uint32)
    with pytest.raises(KeyError, match="demand_N_m.*controllers"):
        Observers("q1", n=1).step(counts, None, 0.0, record=["demand_N_m"])
    with pytest.raises(KeyError, match="stage"):
        Observer("q1").step(counts, None, 0.0, out={"stage": np.zeros(10, dtype=np.uint8)})
    with pytest.raises(TypeError, match="bandwidth"):
        Observers("q1", n=1, bandwidth=60.0)
    assert not hasattr(Observer("q1"), "lead_s")
    leads = Controllers(["q1", "q1"]).lead_s
    assert leads.shape == (2,) and leads[0] == Controller("q1").lead_s > 0
