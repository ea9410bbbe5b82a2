"""Damiao by damiao-motor 1.0.6: damiao_client.py PORT CONTROL TYPE."""
import math
import time

import can
from twin import (HOT_MOTOR, LOST_MOTOR_ENCODER, MOVE, PORT, UNDER_VOLTAGE, WORDS, at_rest, check, check_move,
                  condition, slcan, wait_for)

can.interface.Bus = slcan(can.interface.Bus)

from damiao_motor import DaMiaoController  # noqa: E402: it takes the bus above

(TYPE,) = WORDS
UNDER_VOLTAGE_LIMIT, TIMEOUT, MODE, MOTOR_ANGLE, OUTPUT_ANGLE = 0, 9, 10, 80, 81
MIT, POSITION_VELOCITY, VELOCITY = 1, 2, 3

controller = DaMiaoController(channel=PORT, bustype="slcan")
motor = controller.add_motor(motor_id=1, feedback_id=0x11, motor_type=TYPE)


def read(register):
    """Register as the drive has it now: the client answers from its own memory once it has a value."""
    with motor.registers_lock:
        motor.registers.pop(register, None)
    return motor.get_register(register, timeout=20.0)


def write(register, value):
    """Writes a register and waits until it reads back."""
    motor.write_register(register, value)
    wait_for(lambda: abs(read(register) - value) <= 1e-6 * max(1.0, abs(value)), f"register {register} is {value}")


def state():
    """Feedback as of now. The client takes the answer to a written register for feedback, so it is asked anew."""
    motor.state = {}
    motor.request_motor_feedback()
    end = time.monotonic() + 20.0
    while not motor.state and time.monotonic() < end:
        time.sleep(0.005)
    return dict(motor.state)


def reaches(status, what):
    wait_for(lambda: state().get("status") == status, f"{what}: {status}")


def repeat(seconds, send):
    """Repeats a command and returns the speeds of the feedback."""
    end, speeds = time.monotonic() + seconds, []
    while time.monotonic() < end:
        send()
        time.sleep(0.02)
        speeds.append(motor.state.get("vel", 0.0))
    return speeds


def positions():
    """Angles by both encoders [turns of the output]."""
    return read(MOTOR_ANGLE) / math.tau, read(OUTPUT_ANGLE) / math.tau


def enable():
    motor.enable()
    reaches("ENABLED", "enabled")


try:
    # Connect.
    motor.disable()
    motor.clear_error()
    reaches("DISABLED", "connected")
    check(abs(read(23) - motor._t_max) < 1e-3, "drive and client have the torque range of the type")

    # Enable and move by the MIT frame, which is a spring: 200 N m/rad under 6 N m of weight give 0.005 turns.
    write(TIMEOUT, 0)
    write(MODE, MIT)
    enable()
    start = at_rest(positions)
    goal = start[0] * math.tau
    for part in range(1, 51):
        at = goal + part / 50 * MOVE * math.tau
        repeat(0.03, lambda: motor.send_cmd_mit(at, 0.0, stiffness=200.0, damping=5.0))
    repeat(1.0, lambda: motor.send_cmd_mit(at, 0.0, stiffness=200.0, damping=5.0))
    end = at_rest(positions)
    check_move(end[0] - start[0], end[1] - start[1])

    # Back, then at a speed. Cogging and friction vary it, so its mean counts.
    write(MODE, POSITION_VELOCITY)
    repeat(2.0, lambda: motor.send_cmd_pos_vel(start[0] * math.tau, 3.0))
    back = at_rest(positions)
    check_move(back[0] - start[0], back[1] - start[1], 0.0)
    write(MODE, VELOCITY)
    speeds = repeat(1.5, lambda: motor.send_cmd_vel(0.5))[25:]
    check(abs(sum(speeds) / len(speeds) - 0.5) < 0.1, "mean speed of 0.5 rad/s")
    motor.disable()

    # Watchdog of 50 ms. Requests for feedback would feed it, so silence comes first.
    write(MODE, MIT)
    enable()
    motor.set_can_timeout(50)
    time.sleep(1.0)
    reaches("LOST_COMM", "watchdog expires")
    motor.clear_error()
    reaches("DISABLED", "cleared")
    write(TIMEOUT, 0)

    # A fault that the client can cause: a limit of the voltage above the supply.
    limit = read(UNDER_VOLTAGE_LIMIT)
    enable()
    motor.write_register(UNDER_VOLTAGE_LIMIT, 60.0)
    reaches("UNDER_VOLTAGE", "limit of the voltage")
    # The drive takes limits above 10 V only.
    write(UNDER_VOLTAGE_LIMIT, max(limit, 10.5))
    motor.clear_error()
    reaches("DISABLED", "cleared")

    # Faults by the control socket. The client has no name for a lost encoder, code 5.
    for cause, name in [
        (UNDER_VOLTAGE, "UNDER_VOLTAGE"),
        (HOT_MOTOR, "ROTOR_OVER_TEMP"),
        (LOST_MOTOR_ENCODER, "UNKNOWN(5)"),
    ]:
        enable()
        with condition(*cause):
            reaches(name, f"{cause[0]}")
        time.sleep(0.2)
        motor.clear_error()
        reaches("DISABLED", "cleared")

    # Disable.
    enable()
    motor.disable()
    reaches("DISABLED", "disabled")
finally:
    controller.shutdown()
