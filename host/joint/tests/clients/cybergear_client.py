"""CyberGear and RobStride by pycybergear 1.0.0: cybergear_client.py PORT CONTROL cybergear|rs-02.

The client reads no parameters and shows neither the mode nor the fault bits of the feedback: frames of type 17 and the
identifiers of feedback go over the client's own bus.
"""
import math
import struct
import time

import can
from twin import (HOT_MOTOR, LOST_MOTOR_ENCODER, MOVE, PORT, UNDER_VOLTAGE, WORDS, at_rest, check, check_move,
                  condition, slcan, wait_for, wrapped)

can.interface.Bus = slcan(can.interface.Bus)

import cybergear  # noqa: E402: it takes the bus above

IS_CYBERGEAR = WORDS == ["cybergear"]
# Default identifiers of the twin's drive and of the client.
DRIVE, HOST = 1, 0xFD
READ, FEEDBACK, FAULTS = 17, 2, 21  # Types of frames.
RESET, RUN = 0, 2  # Modes.
CYCLIC_POSITION = 1 if IS_CYBERGEAR else 5
# A CyberGear has no second encoder in its manual: the rotor's angle within a turn is its only raw angle.
ROTOR_ANGLE, OUTPUT_ANGLE, POSITION = 0x3015, 0x3033, 0x7019
CAN_TIMEOUT = 0x200C if IS_CYBERGEAR else 0x7028  # 20000 for 1 s
RATIO = 6

client = cybergear.CyberGear(interface="slcan", channel=PORT, master_can_id=HOST)
bus = client._CyberGear__canbus


def frames(seconds):
    """Frames of a time: type, bits 23 to 8 of the identifier, data."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if (frame := bus.recv(timeout=0.01)) is not None:
            yield frame.arbitration_id >> 24 & 0x1F, frame.arbitration_id >> 8 & 0xFFFF, bytes(frame.data)


def read(index):
    """Parameter as a floating-point number."""
    bus.send(can.Message(arbitration_id=READ << 24 | HOST << 8 | DRIVE, data=struct.pack("<HHL", index, 0, 0)))
    for kind, _, data in frames(20.0):
        if kind == READ and struct.unpack_from("<H", data)[0] == index:
            return struct.unpack_from("<f", data, 4)[0]
    raise SystemExit(f"FAILED: parameter {index:#x} is not answered")


def state(command):
    """Mode and fault bits of the feedback to a command of the client. Every command is answered by feedback: one that
    is not waited for would be taken for the answer to the next command."""
    command()
    for kind, data, _ in frames(20.0):
        if kind == FEEDBACK:
            return data >> 14, data >> 8 & 0x3F
    raise SystemExit("FAILED: no feedback to a command")


def positions():
    """Angles by both encoders [turns of the output]."""
    turns = 1 / math.tau
    return read(POSITION) * turns, read(ROTOR_ANGLE if IS_CYBERGEAR else OUTPUT_ANGLE) * turns


def poll():
    """Mode and fault bits, by a harmless command."""
    return state(lambda: motor.set_speed_limit(5.0))


# Connect.
check(client.ping_motor(DRIVE, timeout=20.0), "the drive answers")
motor = client.init_motor(DRIVE, HOST)
# `init_motor` sends a stop and leaves the answer.
list(frames(1.0))
check(state(lambda: motor.stop_motor(True)) == (RESET, 0), "reset, no fault")

# Enable and move.
start = at_rest(positions)
state(lambda: motor.set_run_mode(CYCLIC_POSITION))
state(lambda: motor.set_speed_limit(5.0))
check(state(motor.enable_motor) == (RUN, 0), "enabled")
state(lambda: motor.send_position_command(start[0] * math.tau + MOVE * math.tau))
time.sleep(1.0)
end = at_rest(positions)
moved, raw = end[0] - start[0], end[1] - start[1]
if IS_CYBERGEAR:
    check(abs(wrapped(raw - RATIO * moved)) < 0.01, "rotor angle and position agree")
    check_move(moved, moved)
else:
    check_move(moved, wrapped(raw))

# Watchdog of 0.2 s: the drive resets without a fault.
state(lambda: motor.write_param(CAN_TIMEOUT, 4000, "L"))
time.sleep(1.0)
check(poll() == (RESET, 0), "watchdog resets the drive")
state(lambda: motor.write_param(CAN_TIMEOUT, 0, "L"))
check(state(motor.enable_motor) == (RUN, 0), "enabled after the watchdog")

# A fault that the client can cause: a limit of temperature below the room's [0.1 deg C].
if IS_CYBERGEAR:
    state(lambda: motor.write_param(0x200D, 100, "h"))
    wait_for(lambda: poll() == (RESET, 1 << 2), "limit of temperature")
    state(lambda: motor.write_param(0x200D, 800, "h"))
    check(state(lambda: motor.stop_motor(True)) == (RESET, 0), "cleared")

# Faults by the control socket.
for cause, bits in [(UNDER_VOLTAGE, 1 << 0), (HOT_MOTOR, 1 << 2), (LOST_MOTOR_ENCODER, 1 << 3)]:
    check(state(motor.enable_motor) == (RUN, 0), "enabled")
    with condition(*cause):
        wait_for(lambda: poll() == (RESET, bits), f"{cause[0]} resets the drive")
    time.sleep(0.2)
    check(state(lambda: motor.stop_motor(True)) == (RESET, 0), "cleared")

# Disable.
check(state(motor.enable_motor) == (RUN, 0), "enabled again")
check(state(motor.stop_motor) == (RESET, 0), "disabled")
client.close()
