"""Log of a reversal test of an ODrive by python-can 4.6.1: odrive_lost_motion.py PORT CONTROL PERIOD LOG.

The twin runs in lockstep: each frame of the client advances the joint by a quarter of PERIOD [s]. Four frames make a
sample: torque, current, output encoder, motor encoder. Prints the torque constant [N m/A].
"""
import csv
import struct

import can
from reversals import torques
from twin import PORT, WORDS

PERIOD, LOG = float(WORDS[0]), WORDS[1]
NODE, RATIO = 1, 6
# Commands of CANSimple, and the endpoints of firmware 0.6.
READ, ANSWER, STATE, ESTIMATES, MODE, TORQUE, CURRENT = 0x04, 0x05, 0x07, 0x09, 0x0B, 0x0E, 0x14
CYCLIC_RATES, TORQUE_CONSTANT, VELOCITY_LIMIT, OUTPUT_ENCODER = range(230, 239), 259, 388, 568

bus = can.Bus(interface="slcan", channel=PORT, bitrate=1000000, sleep_after_open=0)


def send(command, data):
    bus.send(can.Message(arbitration_id=NODE << 5 | command, data=data, is_extended_id=False))


def answer(command, form):
    """Values of the next frame of a command."""
    while (frame := bus.recv(timeout=60.0)) is not None:
        if frame.arbitration_id == NODE << 5 | command:
            return struct.unpack_from("<" + form, frame.data)
    raise SystemExit(f"FAILED: command {command:#x} is not answered")


def ask(command, form):
    bus.send(can.Message(arbitration_id=NODE << 5 | command, is_remote_frame=True, dlc=8, is_extended_id=False))
    return answer(command, form)


def read(endpoint):
    send(READ, struct.pack("<BHB", 0, endpoint, 0))
    return answer(ANSWER, "BHBf")[3]


# Cyclic messages would be taken for answers.
for endpoint in CYCLIC_RATES:
    send(READ, struct.pack("<BHBI", 1, endpoint, 0, 0))
print(read(TORQUE_CONSTANT))
# The limit of the speed acts under torque control as well [turns/s of the motor].
send(READ, struct.pack("<BHBf", 1, VELOCITY_LIMIT, 0, 100.0))
send(MODE, struct.pack("<ii", 1, 1))  # Torque control, passed through.
send(STATE, struct.pack("<i", 8))  # Closed loop.
with open(LOG, "w", newline="") as file:
    log = csv.writer(file)
    log.writerow(["time_s", "pos_estimate", "Iq_measured", "output"])
    for index, torque in enumerate(torques(PERIOD)):
        send(TORQUE, struct.pack("<f", torque / RATIO))
        _, current = ask(CURRENT, "ff")
        output = read(OUTPUT_ENCODER)
        position, _ = ask(ESTIMATES, "ff")
        log.writerow([f"{index * PERIOD:.6f}", position, current, output])
send(STATE, struct.pack("<i", 1))  # Idle.
bus.shutdown()
