"""Motor buses of LeRobot 0.4.4: lerobot_client.py PORT CONTROL damiao|feetech [TYPE].

The buses import parts of LeRobot that need torch, which has half a gigabyte, and never call them: empty modules stand
in for torch and three other packages.
"""
import os
import sys
import time
import types

import can
from twin import (HOT_MOTOR, MOVE, PORT, UNDER_VOLTAGE, WORDS, at_rest, check, check_move, condition, order, slcan,
                  wait_for)


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


def again(call, clear=lambda: None, seconds=60.0):
    """Result of a call that fails as long as an answer is late: LeRobot waits 1 ms for a Damiao. The Feetech SDK takes a
    late answer for that to its next instruction, finds too few bytes in it, and needs a pause and an empty buffer."""
    end = time.monotonic() + seconds
    while True:
        try:
            return call()
        except (ConnectionError, IndexError):
            if time.monotonic() > end:
                raise
            time.sleep(0.5)
            clear()


def state():
    """State and fault of the drive by the control socket: LeRobot reads neither from a Damiao."""
    joint = order(status=True)["joints"][0]
    return joint["state"], joint["fault"]


def link():
    """Angle by the output encoder [turns]. LeRobot knows one encoder only."""
    return order(status=True)["joints"][0]["output_turns"]


def damiao(motor_type):
    from lerobot.motors.damiao import DamiaoMotorsBus

    motor = Motor(1, "damiao", MotorNormMode.DEGREES, motor_type_str=motor_type, recv_id=0x11)
    # A port below /dev makes LeRobot choose slcan.
    bus = DamiaoMotorsBus(os.path.realpath(PORT), {NAME: motor}, use_can_fd=False)

    def connect():
        try:
            bus.connect()
        except ConnectionError:
            # The bus of a failed handshake stays open, and would close the adapter once the next one has opened it.
            bus.canbus.shutdown()
            raise

    again(connect)
    wait_for(lambda: state() == ("Enabled", None), "the handshake enables the drive")

    def positions():
        return again(lambda: bus.read("Present_Position", NAME)) / 360, link()

    # A spring of 200 N m/rad under 6 N m of weight gives 0.005 turns.
    start = at_rest(positions)
    bus.write("Kp", NAME, 200.0)
    bus.write("Kd", NAME, 5.0)
    for part in range(1, 51):
        bus.sync_write("Goal_Position", {NAME: 360 * (start[0] + part / 50 * MOVE)})
        time.sleep(0.03)
    end = at_rest(positions)
    check_move(end[0] - start[0], end[1] - start[1])
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

    def steadily(call, *arguments, **options):
        return again(lambda: call(*arguments, **options), bus.port_handler.clearPort)

    def connect():
        try:
            bus.connect()
        except (ConnectionError, RuntimeError) as error:
            # LeRobot takes a late answer for a missing motor and leaves the port open.
            bus.port_handler.closePort()
            raise ConnectionError from error

    again(connect)
    check(bus.is_connected, "model, firmware and identifier are those of an STS3215")
    steadily(bus.disable_torque)
    steadily(bus.configure_motors)
    steadily(bus.write, "Operating_Mode", NAME, OperatingMode.POSITION.value)
    steadily(bus.write_calibration, {NAME: MotorCalibration(1, 0, 0, 0, 4095)})
    wait_for(lambda: steadily(lambda: bus.is_calibrated), "the calibration reads back")

    def positions():
        return steadily(bus.read, "Present_Position", NAME) / 360, link()

    steadily(bus.enable_torque)
    start = at_rest(positions)
    direction = 1 if start[0] < 0 else -1
    steadily(bus.write, "Goal_Position", NAME, 360 * (start[0] + direction * MOVE))
    end = at_rest(positions)
    check_move(end[0] - start[0], end[1] - start[1], direction * MOVE)

    def refusal(call):
        """Text of the error that the servo reports; empty without one."""
        try:
            steadily(call)
        except RuntimeError as error:
            return str(error).lower()
        return ""

    # A status with an error bit is an exception of LeRobot.
    for cause, word in [(UNDER_VOLTAGE, "voltage"), (HOT_MOTOR, "heat")]:
        with condition(*cause):
            wait_for(lambda: word in refusal(positions), f"{word} is reported")
        wait_for(lambda: refusal(lambda: bus.write("Torque_Enable", NAME, 1)) == "", "cleared by the torque switch")
    steadily(bus.disconnect)
    wait_for(lambda: state()[0] == "Disabled", "disconnected without torque")


{"damiao": damiao, "feetech": feetech}[WORDS[0]](*WORDS[1:])
