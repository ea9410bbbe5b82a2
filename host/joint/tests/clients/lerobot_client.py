"""Motor buses of LeRobot 0.4.4: lerobot_client.py PORT CONTROL damiao|feetech [TYPE].

The buses import parts of LeRobot that need torch, which has half a gigabyte, and never call them: empty modules stand
in for torch and three other packages.
"""
import math
import sys
import time
import types

import can
from twin import HOT_MOTOR, MOVE, PORT, UNDER_VOLTAGE, WORDS, check, condition, order, slcan, wait_for


class Absent(types.ModuleType):
    """Module in which every name is an empty class."""

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return type(name, (), {})


for package in ["torch", "accelerate", "datasets", "datasets.utils", "datasets.utils.logging", "draccus",
                "draccus.choice_types"]:
    sys.modules[package] = Absent(package)

can.interface.Bus = slcan(can.interface.Bus)

from lerobot.motors import Motor, MotorNormMode  # noqa: E402: they take the modules above

NAME = "hip"


def again(call, seconds=20.0):
    """Result of a call that fails as long as an answer is late: LeRobot waits 1 ms for a Damiao."""
    end = time.monotonic() + seconds
    while True:
        try:
            return call()
        except ConnectionError:
            if time.monotonic() > end:
                raise
            time.sleep(0.1)


def state():
    """State and fault of the drive by the control socket: LeRobot reads neither from a Damiao."""
    joint = order(status=True)["joints"][0]
    return joint["state"], joint["fault"]


def link():
    """Angle by the output encoder [deg]. LeRobot knows one encoder only."""
    return 360 * order(status=True)["joints"][0]["output_turns"]


def damiao(motor_type):
    from lerobot.motors.damiao import DamiaoMotorsBus

    motor = Motor(1, "damiao", MotorNormMode.DEGREES, motor_type_str=motor_type, recv_id=0x11)
    bus = DamiaoMotorsBus(PORT, {NAME: motor}, use_can_fd=False)
    again(bus.connect)
    wait_for(lambda: state() == ("Enabled", None), "the handshake enables the drive")

    def position():
        return again(lambda: bus.read("Present_Position", NAME))

    # A spring of 200 N m/rad under 6 N m of weight gives 0.005 turns.
    start, link_start = position(), link()
    bus.write("Kp", NAME, 200.0)
    bus.write("Kd", NAME, 5.0)
    for part in range(1, 51):
        bus.sync_write("Goal_Position", {NAME: start + part / 50 * 360 * MOVE})
        time.sleep(0.03)
    time.sleep(1.0)
    moved, link_moved = position() - start, link() - link_start
    check(abs(moved - 360 * MOVE) < 3.6, f"motor encoder moved by {moved:.2f} deg")
    check(abs(link_moved - moved) < 0.8, f"output encoder moved by {link_moved:.2f} deg")
    states = bus.sync_read_all_states()[NAME]
    check(abs(states["torque"]) < 12 and 0 < states["temp_rotor"] < 100, f"torque and temperature: {states}")

    # LeRobot shows no fault, but a disabled drive follows no goal.
    for cause, fault in [(UNDER_VOLTAGE, "UnderVoltage"), (HOT_MOTOR, "OverTemperature")]:
        with condition(*cause):
            wait_for(lambda: state() == ("Disabled", fault), f"{fault} takes the torque off")
        order(end_faults=True)
        # Only the order 0xFB clears a fault of a Damiao; LeRobot has none.
        bus.canbus.send(can.Message(arbitration_id=1, data=[0xFF] * 7 + [0xFB], is_extended_id=False))
        wait_for(lambda: state() == ("Disabled", None), "cleared")
        again(bus.enable_torque)
        wait_for(lambda: state() == ("Enabled", None), "enabled")
    bus.disconnect()
    wait_for(lambda: state()[0] == "Disabled", "disconnected without torque")


def feetech():
    from lerobot.motors import MotorCalibration
    from lerobot.motors.feetech import FeetechMotorsBus, OperatingMode

    motors = {NAME: Motor(1, "sts3215", MotorNormMode.DEGREES)}
    bus = FeetechMotorsBus(PORT, motors)
    again(bus.connect)
    check(bus.is_connected, "model, firmware and identifier are those of an STS3215")
    bus.disable_torque(num_retry=10)
    bus.configure_motors()
    bus.write("Operating_Mode", NAME, OperatingMode.POSITION.value, num_retry=10)
    bus.write_calibration({NAME: MotorCalibration(1, 0, 0, 0, 4095)})
    check(bus.is_calibrated, "the calibration reads back")

    def position():
        return bus.read("Present_Position", NAME, num_retry=10)

    bus.enable_torque(num_retry=10)
    start, link_start = position(), link()
    direction = 1 if start < 0 else -1
    bus.write("Goal_Position", NAME, start + direction * 360 * MOVE, num_retry=10)
    time.sleep(2.0)
    moved, link_moved = position() - start, link() - link_start
    check(abs(moved - direction * 360 * MOVE) < 3.6, f"moved by {moved:.2f} deg")
    check(abs(link_moved - moved) < 0.8, f"output encoder moved by {link_moved:.2f} deg")

    # A status with an error bit is an exception of LeRobot.
    for cause, word in [(UNDER_VOLTAGE, "voltage"), (HOT_MOTOR, "heat")]:
        with condition(*cause):
            wait_for(lambda: fails(position, word), f"{word} is reported")
        bus.write("Torque_Enable", NAME, 1, num_retry=10) if state()[1] is None else time.sleep(0.2)
        wait_for(lambda: not fails(lambda: bus.write("Torque_Enable", NAME, 1), ""), "cleared by the torque switch")
    bus.disconnect()
    wait_for(lambda: state()[0] == "Disabled", "disconnected without torque")


def fails(call, word):
    """True if a call reports an error of the servo with a word in its text."""
    try:
        call()
    except ConnectionError:
        return False
    except RuntimeError as error:
        return word in str(error).lower()
    return False


{"damiao": damiao, "feetech": feetech}[WORDS[0]](*WORDS[1:])
