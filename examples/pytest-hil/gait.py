"""Gait of a hip, commanded to a moteus drive by its maker's client."""

import asyncio
import math

import moteus
from moteus import Register, multiplex

#: Time for which the hip is held before it walks [s].
HOLD = 2.0


def hip(time):
    """Angle [turns] and speed [turns/s] of a hip that walks at 1 Hz; the joint hangs straight down at zero."""
    if time < 0:
        return 0.0, 0.0
    phase = 2 * math.pi * time
    angle = 0.06 * math.sin(phase) + 0.01 * (1 - math.cos(2 * phase))
    speed = 2 * math.pi * (0.06 * math.cos(phase) + 0.02 * math.sin(2 * phase))
    return angle, speed


def walk(twin, seconds=3.0, at=None):
    """Holds the hip for two seconds, then walks. Calls the functions of `at` at their times [s], which are negative
    while the hip is held. Returns a row for each command of the gait, with angles in degrees."""
    return asyncio.run(_walk(twin, seconds, sorted((at or {}).items())))


async def _walk(twin, seconds, events):
    query = moteus.QueryResolution()
    query.position = query.torque = multiplex.F32
    query._extra = {Register.ENCODER_1_POSITION: multiplex.F32}
    # Simulated time stands still between frames: the client waits for a slow machine and does not repeat a frame.
    transport = moteus.Fdcanusb(twin.port, command_timeout=30.0, response_timeout=30.0)
    rows = []
    try:
        drive = moteus.Controller(id=1, query_resolution=query, transport=transport)
        if twin.home is None:
            twin.home = (await drive.set_stop(query=True)).values[Register.POSITION]
        for step in range(round(-HOLD / twin.step), round(seconds / twin.step)):
            time = step * twin.step
            while events and events[0][0] <= time:
                events.pop(0)[1]()
            angle, speed = hip(time)
            answer = await drive.set_position(
                position=twin.home + angle, velocity=speed, watchdog_timeout=0.5, query=True)
            values = answer.values
            if time >= 0:
                # Encoder 1 reads one turn of the output, 0 to 1.
                output = (values[Register.ENCODER_1_POSITION] - twin.home + 0.5) % 1.0 - 0.5
                rows.append({"time": time, "command": 360 * angle, "output": 360 * output,
                             "motor": 360 * (values[Register.POSITION] - twin.home),
                             "torque": values[Register.TORQUE], "mode": values[Register.MODE],
                             "fault": values[Register.FAULT]})
    finally:
        transport.close()
    return rows


def tracking_error(rows):
    """RMS error of the output after the first second [deg]."""
    errors = [row["output"] - row["command"] for row in rows if row["time"] >= 1.0]
    return math.sqrt(sum(error**2 for error in errors) / len(errors))


def play(rows):
    """Range of the difference of both encoders after the first second [deg]."""
    differences = [row["output"] - row["motor"] for row in rows if row["time"] >= 1.0]
    return max(differences) - min(differences)
