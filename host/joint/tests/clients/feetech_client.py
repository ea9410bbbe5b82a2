"""Feetech STS3215 by feetech-servo-sdk 1.0.0 at a supply of 12 V: feetech_client.py PORT CONTROL."""
import time

import scservo_sdk
from twin import (HOT_MOTOR, LOST_OUTPUT_ENCODER, MOVE, PORT, UNDER_VOLTAGE, at_rest, check, check_move, condition,
                  wait_for)

SERVO, STEPS = 1, 4096
# Registers of the maker's memory table, with their width in bytes.
MAX_TEMPERATURE, UNLOADING = (13, 1), (19, 1)
TORQUE, POSITION, VOLTAGE, STATUS = (40, 1), (56, 2), (62, 1), (65, 1)
# Encoder at the motor and gear ratio: an extension of the twin's drive.
MOTOR_POSITION, MOTOR_COUNTS, RATIO = (96, 4), (100, 4), (108, 4)
# Bits of the error byte.
VOLTAGE_ERROR, ENCODER_ERROR, TEMPERATURE_ERROR = 1, 2, 4

port = scservo_sdk.PortHandler(PORT)
packets = scservo_sdk.protocol_packet_handler()


def exchange(send):
    """Values of an exchange, whose result stands before the last of them.

    The SDK waits 34 ms for an answer and takes a late one for that to its next instruction. A busy machine answers
    late, so the exchange is repeated after a pause, with an empty buffer.
    """
    for _ in range(10):
        values = send()
        if values[-2] == scservo_sdk.COMM_SUCCESS:
            return values
        time.sleep(1.0)
        port.ser.reset_input_buffer()
        port.is_using = False
    raise SystemExit(f"FAILED: {packets.getTxRxResult(values[-2])}")


def read(register):
    """Value of a register and the error byte."""
    address, width = register
    data, _, error = exchange(lambda: packets.readTxRx(port, SERVO, address, width))
    return int.from_bytes(bytes(data), "little"), error


def get(register):
    return read(register)[0]


def put(register, value):
    address, width = register
    data = list(value.to_bytes(width, "little"))
    exchange(lambda: packets.writeTxRx(port, SERVO, address, width, data))


def positions():
    """Angles by motor and output encoder [turns of the output]."""
    rotor = (get(MOTOR_POSITION) ^ 1 << 31) - (1 << 31)  # signed
    numerator, denominator = get(RATIO) & 0xFFFF, get(RATIO) >> 16
    return rotor / get(MOTOR_COUNTS) * denominator / numerator, get(POSITION) / STEPS


# Connect.
check(port.openPort(), "the port opens")
model, _, error = exchange(lambda: packets.ping(port, SERVO))
check((model, error) == (777, 0), "an STS3215 without an error answers")
check(110 <= get(VOLTAGE) <= 130, "supply of 12 V")

# Enable and move: acceleration, goal, time, speed, as the maker's library writes them. A turn has 4096 steps, and the
# goal must not leave it.
put(TORQUE, 1)
start = at_rest(positions)
direction = 1 if start[1] < 0.5 else -1
goal = get(POSITION) + direction * round(MOVE * STEPS)
exchange(lambda: packets.writeTxRx(port, SERVO, 41, 7, [50, *goal.to_bytes(2, "little"), 0, 0, 0xE8, 0x03]))
time.sleep(1.0)
end = at_rest(positions)
check_move(end[0] - start[0], end[1] - start[1], direction * MOVE)

# The servo has no watchdog: silence leaves the torque on.
time.sleep(1.0)
check(get(TORQUE) == 1, "silence leaves the torque on")

# A fault that the client can cause: a limit of temperature below the room's.
limit = get(MAX_TEMPERATURE)
put(MAX_TEMPERATURE, 10)
wait_for(lambda: read(STATUS) == (TEMPERATURE_ERROR, TEMPERATURE_ERROR), "limit of temperature")
check(get(TORQUE) == 0, "the torque is off")
put(MAX_TEMPERATURE, limit)
time.sleep(0.2)
put(TORQUE, 1)
wait_for(lambda: read(STATUS) == (0, 0), "cleared by the torque switch")

# Faults by the control socket. Voltage and encoder take the torque off if register 19 says so.
put(UNLOADING, get(UNLOADING) | VOLTAGE_ERROR | ENCODER_ERROR)
for cause, error in [
    (UNDER_VOLTAGE, VOLTAGE_ERROR),
    (HOT_MOTOR, TEMPERATURE_ERROR),
    (LOST_OUTPUT_ENCODER, ENCODER_ERROR),
]:
    with condition(*cause):
        wait_for(lambda: read(STATUS)[0] == error, f"{cause[0]}")
        check(get(TORQUE) == 0, "the torque is off")
    time.sleep(0.2)
    put(TORQUE, 1)
    wait_for(lambda: read(STATUS) == (0, 0), "cleared")

# Disable.
put(TORQUE, 0)
check(get(TORQUE) == 0, "disabled")
port.closePort()
