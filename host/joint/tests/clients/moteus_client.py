"""moteus 1.1.1 on fdcanusb or slcan: moteus_client.py PORT CONTROL fdcanusb|slcan."""
import asyncio
import math

import moteus
from moteus import Mode, Register
from moteus import multiplex as mp
from twin import (HAS_CONTROL, HOT_MOTOR, LOST_MOTOR_ENCODER, LOST_OUTPUT_ENCODER, MOVE, PORT, UNDER_VOLTAGE, WORDS,
                  check, check_move, condition, wrapped)

RATIO = 6
# The default of 0.1 s would expire while a busy machine stops the client.
WATCHDOG = 5.0  # [s]


def transport():
    if WORDS == ["fdcanusb"]:
        return moteus.Fdcanusb(PORT)
    return moteus.PythonCan(interface="slcan", channel=PORT, bitrate=1000000, sleep_after_open=0)


async def main():
    # Encoder 0 sits at the motor, encoder 1 at the output.
    query = moteus.QueryResolution()
    query.home_state = mp.INT8
    query._extra = {
        Register.ENCODER_0_POSITION: mp.F32,
        Register.ENCODER_1_POSITION: mp.F32,
        Register.ENCODER_VALIDITY: mp.INT8,
    }
    line = transport()
    drive = moteus.Controller(id=1, query_resolution=query, transport=line)

    async def values():
        return (await asyncio.wait_for(drive.query(), 20.0)).values

    async def state():
        now = await values()
        return now[Register.MODE], now[Register.FAULT]

    async def reaches(wanted, what):
        """Waits for a mode and a fault."""
        for _ in range(400):
            now = await state()
            if now == wanted:
                break
            await asyncio.sleep(0.05)
        check(now == wanted, f"{what}: mode {now[0]}, fault {now[1]}")

    # Connect.
    await drive.set_stop()
    await reaches((Mode.STOPPED, 0), "stopped")
    start = await values()
    check(start[Register.ENCODER_VALIDITY] == 0b1111, "both encoders are valid")
    check(start[Register.HOME_STATE] == 2, "position refers to the output")
    found = await line.discover(can_prefix=0)
    check([device.address.can_id for device in found] == [1], "the drive is discovered")

    # Enable and move.
    target = start[Register.POSITION] + MOVE
    await asyncio.wait_for(
        drive.set_position_wait_complete(
            position=target, velocity_limit=0.2, accel_limit=1.0, watchdog_timeout=WATCHDOG, period_s=0.02), 60.0)
    for _ in range(50):
        await drive.set_position(position=target, watchdog_timeout=WATCHDOG)
        await asyncio.sleep(0.02)
    end = await values()
    # Encoder 0 counts within a turn of the rotor, position is the motor's angle at the output.
    rotor = end[Register.ENCODER_0_POSITION] - start[Register.ENCODER_0_POSITION]
    moved = end[Register.POSITION] - start[Register.POSITION]
    check(abs(wrapped(rotor - RATIO * moved)) < 0.01, "encoder 0 and position agree")
    check_move(moved, wrapped(end[Register.ENCODER_1_POSITION] - start[Register.ENCODER_1_POSITION]))

    # Watchdog: mode 11 until a stop.
    await drive.set_position(position=target, watchdog_timeout=0.1)
    await reaches((Mode.TIMEOUT, 0), "watchdog of 0.1 s expires")
    await drive.set_position(position=math.nan, watchdog_timeout=WATCHDOG)
    await reaches((Mode.TIMEOUT, 0), "commands are ignored after the watchdog")
    await drive.set_stop()
    await reaches((Mode.STOPPED, 0), "stop clears the watchdog")

    # A fault that the client can cause: a stop position with acceleration limits.
    await drive.set_position(position=math.nan, velocity=0.1, stop_position=target, watchdog_timeout=WATCHDOG)
    await reaches((Mode.FAULT, 45), "stop position with acceleration limits")
    await drive.set_stop()
    await reaches((Mode.STOPPED, 0), "cleared")

    faults = [(40, UNDER_VOLTAGE), (38, HOT_MOTOR), (35, LOST_MOTOR_ENCODER), (43, LOST_OUTPUT_ENCODER)]
    for code, (cause, end) in faults if HAS_CONTROL else []:
        await drive.set_position(position=math.nan, watchdog_timeout=math.nan)
        await reaches((Mode.POSITION, 0), "enabled")
        with condition(cause, end):
            await reaches((Mode.FAULT, code), str(cause))
        await asyncio.sleep(0.2)
        await drive.set_stop()
        await reaches((Mode.STOPPED, 0), "cleared")

    # Disable.
    await drive.set_position(position=math.nan, watchdog_timeout=math.nan)
    await reaches((Mode.POSITION, 0), "enabled again")
    await drive.set_stop()
    await reaches((Mode.STOPPED, 0), "disabled")
    line.close()


asyncio.run(main())
