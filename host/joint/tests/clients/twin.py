"""Helpers of the client scripts: arguments, checks, and the control socket of `joint twin`.

Each script is called with the port of the twin, the path of its control socket, and words of its own. A firmware image
has no control socket: the path is `-`, and faults by the socket are left out.
"""
import contextlib
import json
import socket
import sys
import time

PORT, CONTROL = sys.argv[1:3]
WORDS = sys.argv[3:]
HAS_CONTROL = CONTROL != "-"

MOVE = 0.1  # Motion of the output in every script [turns].
# The drives' own laws bend under the weight of the link: 6 N m over a stiffness of 250 N m/rad is 0.004 turns.
# Friction of 0.3 N m adds 0.0002 turns.
POSITION_TOLERANCE = 0.01  # [turns]
# Between the encoders lie 3.8 mrad of lost motion, 1.2 mrad of wind-up at 12 N m and 0.6 mrad of encoder errors:
# 0.0009 turns.
ENCODER_TOLERANCE = 0.002  # [turns]


def check(condition, what):
    """Ends the script unless the condition holds."""
    if not condition:
        raise SystemExit(f"FAILED: {what}")
    print("ok:", what, flush=True)


def wait_for(condition, what, seconds=20.0):
    """Waits for a condition. The limit is long, since a busy machine may stop client and twin for seconds."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise SystemExit(f"FAILED: {what}: not within {seconds} s")
        time.sleep(0.01)
    print("ok:", what, flush=True)


def wrapped(turns):
    """Difference of two angles of an encoder of one turn, within half a turn."""
    return (turns + 0.5) % 1.0 - 0.5


def check_move(motor, output, wanted=MOVE):
    """Checks the motion that both encoders saw [turns of the output]."""
    check(abs(motor - wanted) < POSITION_TOLERANCE, f"motor encoder moved by {motor:.4f} turns of the output")
    check(abs(output - motor) < ENCODER_TOLERANCE, f"output encoder moved by {output:.4f} turns")


def at_rest(positions):
    """Angles of both encoders once the joint stands still. A disabled joint swings under the weight of its link, and
    most clients read one encoder after the other."""
    readings, end = [positions()], time.monotonic() + 60.0
    while time.monotonic() < end:
        time.sleep(0.2)
        readings = [*readings[-2:], positions()]
        changes = [abs(now - before) for angles in zip(*readings) for now, before in zip(angles[1:], angles)]
        if len(readings) == 3 and max(changes) < ENCODER_TOLERANCE / 10:
            return readings[-1]
    raise SystemExit(f"FAILED: the joint moves: {readings}")


def order(**keys):
    """Sends a command to the control socket; returns the answer."""
    with socket.socket(socket.AF_UNIX) as line:
        line.settimeout(20.0)
        line.connect(CONTROL)
        line.sendall(json.dumps(keys).encode() + b"\n")
        answer = json.loads(line.makefile().readline())
    if "error" in answer:
        raise SystemExit(f"FAILED: {keys}: {answer}")
    return answer


# Voltage of the supply, to which it returns after a fault [V].
SUPPLY = round(order(status=True)["joints"][0]["bus_V"]) if HAS_CONTROL else 48
# Faults by the control socket: the command that causes the condition, and the one that ends it.
# moteus and ODrive run down to 4 and 8 V by default.
UNDER_VOLTAGE = {"supply_V": 3}, {"supply_V": SUPPLY}
HOT_MOTOR = {"motor_temperature_C": 150}, {"motor_temperature_C": 25}
LOST_MOTOR_ENCODER = {"fault": {"kind": "lost_frames", "frames": "motor", "share": 1.0}}, {"end_faults": True}
LOST_OUTPUT_ENCODER = {"fault": {"kind": "lost_frames", "frames": "output", "share": 1.0}}, {"end_faults": True}


@contextlib.contextmanager
def condition(cause, end):
    """Causes a condition for the time of a `with` block."""
    order(**cause)
    try:
        yield
    finally:
        order(**end)


def slcan(bus_class):
    """Returns a function that opens a bus of python-can without a pause of 2 s.

    python-can waits for an Arduino to boot unless `sleep_after_open` is 0, and some clients cannot pass it on.
    """

    def opened(*arguments, **options):
        options.pop("extended", None)  # pycybergear passes it, slcan has no such option.
        return bus_class(*arguments, **options, sleep_after_open=0)

    return opened
