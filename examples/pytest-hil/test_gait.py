"""Gait of a hip with backlash, wear and faults."""

import pytest
from conftest import Twin
from damiao import ENABLED, UNDER_VOLTAGE, Damiao
from gait import play, tracking_error, walk

MOTEUS_POSITION, MOTEUS_FAULT = 10, 1
MOTEUS_UNDER_VOLTAGE = 40


#: Range of the encoders' errors on the joint q1 [deg]: once a turn 0.02 each way, and 50 us between both readings at
#: 330 deg/s; the values are in joints/q1.toml.
ENCODERS = 2 * 0.02 + 50e-6 * 330


def elastic_play(rows, joint):
    """Range of the twist of the gear under the torques of a gait [deg]; the wind-up is that at rated torque."""
    torques = [row["torque"] for row in rows]
    return (max(torques) - min(torques)) / joint["rated_torque_N_m"] * joint["wind_up_deg"]


@pytest.mark.parametrize("twin", [dict(seed=1), dict(seed=2)], indirect=True, ids=["seed1", "seed2"])
@pytest.mark.parametrize("degrees", [0, 0.25, 0.5, 1])
def test_play_is_backlash_and_twist(twin, geometry, degrees, record_property):
    joint = geometry(twin.joint)
    rows = walk(twin, at={-1.0: lambda: twin.control(half_backlash_um=degrees * joint["um_per_deg"])})
    record_property("play_deg", play(rows))
    record_property("tracking_error_deg", tracking_error(rows))
    assert {row["mode"] for row in rows} == {MOTEUS_POSITION}
    assert degrees < play(rows) < degrees + elastic_play(rows, joint) + ENCODERS


def test_error_grows_with_backlash(twin, geometry):
    joint = geometry(twin.joint)
    widths = [0, 0.25, 0.5, 1]
    errors = []
    for degrees in widths:
        half_backlash = degrees * joint["um_per_deg"]
        errors.append(tracking_error(walk(twin, at={-1.0: lambda: twin.control(half_backlash_um=half_backlash)})))
    assert errors == sorted(errors)
    # The gap can move the output by its whole width at most.
    for degrees, error in zip(widths, errors):
        assert error < errors[0] + degrees + 0.01, errors


def test_wear_during_a_gait_shows_as_play(twin, geometry):
    joint = geometry(twin.joint)
    worn = 3 * joint["half_backlash_um"]
    rows = walk(twin, 6.0, at={3.0: lambda: twin.control(half_backlash_um=worn)})
    new, old = play([row for row in rows if row["time"] < 3]), play([row for row in rows if row["time"] >= 4])
    assert old - new == pytest.approx(2 * joint["lost_motion_deg"], rel=0.2)


@pytest.mark.parametrize("share", [0.02, 0.05])
def test_slip_of_the_output_encoder_shows_as_difference(twin, geometry, share):
    joint = geometry(twin.joint)
    slip = dict(kind="encoder_missing_counts", encoder="output", share=share)
    rows = walk(twin, 4.0, at={2.0: lambda: twin.control(fault=slip)})
    sound, slipping = [row for row in rows if row["time"] < 2], [row for row in rows if row["time"] >= 2]
    travel = max(row["motor"] for row in slipping) - min(row["motor"] for row in slipping)
    assert play(sound) < joint["lost_motion_deg"] + elastic_play(rows, joint) + ENCODERS
    assert play(slipping) == pytest.approx(share * travel, abs=play(sound))
    # The drive controls by the motor encoder and does not see the slip.
    assert {row["mode"] for row in rows} == {MOTEUS_POSITION}


def test_brown_out_stops_a_moteus(twin):
    supply = round(twin.status()["bus_V"])
    # A moteus runs down to 4 V.
    rows = walk(twin, 2.0, at={1.0: lambda: twin.control(supply_V=3), 1.1: lambda: twin.control(supply_V=supply)})
    before, after = [row for row in rows if row["time"] < 1], [row for row in rows if row["time"] > 1.01]
    assert {row["mode"] for row in before} == {MOTEUS_POSITION}
    assert {(row["mode"], row["fault"]) for row in after} == {(MOTEUS_FAULT, MOTEUS_UNDER_VOLTAGE)}
    assert twin.status()["fault"] == "UnderVoltage"


@pytest.mark.parametrize("twin", [dict(drive="damiao")], indirect=True, ids=["damiao"])
def test_brown_out_stops_a_damiao(twin):
    supply = round(twin.status()["bus_V"])
    drive = Damiao(twin.port)
    try:
        _, here = drive.order(0xFC)
        states = [drive.impedance(here, 100, 5)[0] for _ in range(20)]
        assert set(states) == {ENABLED}
        twin.control(supply_V=supply / 3)  # The default under-voltage limit of a Damiao is half of its supply.
        states = [drive.impedance(here, 100, 5)[0] for _ in range(20)]
        assert set(states[2:]) == {UNDER_VOLTAGE}
        twin.control(supply_V=supply)
        drive.order(0xFB)
        drive.order(0xFC)
        states = [drive.impedance(here, 100, 5)[0] for _ in range(20)]
        assert set(states[2:]) == {ENABLED}
    finally:
        drive.close()


def test_same_seed_repeats_every_bit(twin, tmp_path_factory):
    other = Twin(tmp_path_factory.mktemp("other"))
    try:
        assert walk(twin, 1.0) == walk(other, 1.0)
    finally:
        other.close()
