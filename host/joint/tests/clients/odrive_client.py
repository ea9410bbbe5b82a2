"""ODrive by CANSimple with python-can 4.6.1 and cantools 45.1.0: odrive_client.py PORT CONTROL 0.5|0.6.

The maker's DBC files come with the package odrive-can, which is not imported: it wants more packages than its files do.
"""
import importlib.util
import pathlib
import struct
import time

import can
import cantools
from twin import (HAS_CONTROL, HOT_MOTOR, LOST_MOTOR_ENCODER, MOVE, PORT, UNDER_VOLTAGE, WORDS, at_rest, check,
                  check_move, condition, wait_for, wrapped)

IS_05 = WORDS == ["0.5"]
NODE, RATIO = 1, 6
IDLE, CLOSED_LOOP = 1, 8
POSITION, PASSTHROUGH, TRAPEZOIDAL = 3, 1, 5
# Endpoints of firmware 0.6 as the drive numbers them, and their types.
ENDPOINTS = {"watchdog_timeout": (200, "f"), "enable_watchdog": (201, "?"), "spi_encoder0.raw": (568, "f")}

folder = pathlib.Path(importlib.util.find_spec("odrive_can").submodule_search_locations[0], "dbc")
db = cantools.database.load_file(folder / ("odrive-cansimple-0.5.6.dbc" if IS_05 else "odrive-cansimple-0.6.10.dbc"))
bus = can.Bus(interface="slcan", channel=PORT, bitrate=1000000, sleep_after_open=0)


def frame(name, node, data=None):
    """Frame of a message; a request for it without data. The DBC has axes 0 to 7: axis 0 plus the node serves all."""
    identifier = node << 5 | db.get_message_by_name("Axis0_" + name).frame_id
    request = {"is_remote_frame": True, "dlc": 8} if data is None else {"data": data}
    return can.Message(arbitration_id=identifier, is_extended_id=False, **request)


def send(name, **signals):
    bus.send(frame(name, NODE, db.get_message_by_name("Axis0_" + name).encode(signals)))


def receive(name, node=NODE):
    """Next message of a name, decoded."""
    message, end = db.get_message_by_name("Axis0_" + name), time.monotonic() + 20.0
    while time.monotonic() < end:
        found = bus.recv(timeout=0.1)
        if found and not found.is_remote_frame and found.arbitration_id == node << 5 | message.frame_id:
            return message.decode(found.data, decode_choices=False)
    raise SystemExit(f"FAILED: no {name} from node {node}")


def flush():
    """Drops received frames: a cyclic message would be taken for the answer."""
    while bus.recv(timeout=0) is not None:
        pass


def ask(name, node=NODE):
    flush()
    bus.send(frame(name, node))
    return receive(name, node)


def sdo(name, value=None):
    """Reads an endpoint of firmware 0.6, or writes it."""
    endpoint, kind = ENDPOINTS[name]
    flush()
    payload = b"" if value is None else struct.pack("<" + kind, value)
    bus.send(can.Message(arbitration_id=NODE << 5 | 0x04, is_extended_id=False,
                         data=struct.pack("<BHB", value is not None, endpoint, 0) + payload))
    while value is None:
        found = bus.recv(timeout=20.0)
        if found is None:
            raise SystemExit(f"FAILED: no answer for endpoint {name}")
        if found.arbitration_id == NODE << 5 | 0x05:
            return struct.unpack_from("<BHB" + kind, found.data)[3]


def is_state(state):
    flush()
    return receive("Heartbeat")["Axis_State"] == state


def errors():
    """Error word of 0.6; those of axis, motor, encoder and controller of 0.5."""
    flush()
    axis = receive("Heartbeat")["Axis_Error"]
    if not IS_05:
        return axis
    return axis, ask("Get_Motor_Error")["Motor_Error"], ask("Get_Encoder_Error")["Encoder_Error"]


def enable():
    send("Set_Controller_Mode", Control_Mode=POSITION, Input_Mode=PASSTHROUGH)
    send("Set_Axis_State", Axis_Requested_State=CLOSED_LOOP)
    wait_for(lambda: is_state(CLOSED_LOOP), "closed loop")


def clear():
    send("Clear_Errors", **({} if IS_05 else {"Identify": 0}))
    wait_for(lambda: errors() in (0, (0, 0, 0)), "errors cleared")


def positions():
    """Angles by motor and output encoder [turns of the output]. 0.5 has the output encoder on a second axis."""
    motor = ask("Get_Encoder_Estimates")["Pos_Estimate"] / RATIO
    if IS_05:
        return motor, ask("Get_Encoder_Estimates", NODE + 1)["Pos_Estimate"]
    return motor, sdo("spi_encoder0.raw")


# Connect.
receive("Heartbeat")
check(abs(ask("Get_Bus_Voltage_Current")["Bus_Voltage"] - 48) < 3, "bus voltage of 48 V")
clear()

# Enable and move on a trapezoidal profile.
start = at_rest(positions)
enable()
send("Set_Traj_Vel_Limit", Traj_Vel_Limit=2.0)
send("Set_Traj_Accel_Limits", Traj_Accel_Limit=4.0, Traj_Decel_Limit=4.0)
send("Set_Controller_Mode", Control_Mode=POSITION, Input_Mode=TRAPEZOIDAL)
send("Set_Input_Pos", Input_Pos=RATIO * (start[0] + MOVE), Vel_FF=0.0, Torque_FF=0.0)
time.sleep(2.0)
end = at_rest(positions)
check_move(end[0] - start[0], wrapped(end[1] - start[1]))

# Watchdog. CANSimple of 0.5 cannot set it.
if not IS_05:
    sdo("watchdog_timeout", 2.0)
    sdo("enable_watchdog", True)
    for _ in range(50):
        send("Set_Input_Vel", Input_Vel=0.0, Input_Torque_FF=0.0)
        time.sleep(0.1)
    check(is_state(CLOSED_LOOP), "frames feed the watchdog of 2 s")
    wait_for(lambda: is_state(IDLE), "silence expires the watchdog")
    check(errors() == 0x01000000, "watchdog timer expired")
    sdo("enable_watchdog", False)
    clear()

# A fault that the client can cause: emergency stop.
enable()
bus.send(can.Message(arbitration_id=NODE << 5 | 0x02, is_extended_id=False))
wait_for(lambda: is_state(IDLE), "emergency stop")
check(errors() == ((0x4000, 0, 0) if IS_05 else 0x02000000), "stop requested")
clear()

# Faults by the control socket: errors of 0.6, and of axis, motor and encoder of 0.5.
for cause, code, legacy in [
    (UNDER_VOLTAGE, 0x200, (0x40, 0x1000000, 0)),
    (HOT_MOTOR, 0x2000, (0x40, 0x20000, 0)),
    (LOST_MOTOR_ENCODER, 0x8, (0x100, 0, 0x80)),
] if HAS_CONTROL else []:
    enable()
    with condition(*cause):
        wait_for(lambda: is_state(IDLE), f"{cause[0]} disarms")
        check(errors() == (legacy if IS_05 else code), "error code")
    time.sleep(0.2)
    clear()

# Disable.
enable()
send("Set_Axis_State", Axis_Requested_State=IDLE)
wait_for(lambda: is_state(IDLE), "disabled")
bus.shutdown()
