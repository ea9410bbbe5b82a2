"""Log of a reversal test by moteus 1.1.1: moteus_lost_motion.py PORT CONTROL PERIOD LOG.

The twin runs in lockstep: each frame of the client advances the joint by PERIOD [s], so that samples are even.
"""
import asyncio
import csv
import math

import moteus
from moteus import Register
from moteus import multiplex as mp
from reversals import torques
from twin import PORT, WORDS

PERIOD, LOG = float(WORDS[0]), WORDS[1]


async def main():
    query = moteus.QueryResolution()
    query.torque = mp.F32
    query._extra = {Register.ENCODER_0_POSITION: mp.F32, Register.ENCODER_1_POSITION: mp.F32}
    columns = [Register.ENCODER_0_POSITION, Register.ENCODER_1_POSITION, Register.TORQUE]
    line = moteus.Fdcanusb(PORT)
    # 32 bits for torque and gain scales: the default of the client leaves gain scales out.
    precise = moteus.PositionResolution()
    precise.kp_scale = precise.kd_scale = mp.F32
    drive = moteus.Controller(id=1, query_resolution=query, position_resolution=precise, transport=line)
    await drive.set_stop()
    with open(LOG, "w", newline="") as file:
        log = csv.writer(file)
        log.writerow(["time_s", *(column.name for column in columns)])
        for index, torque in enumerate(torques(PERIOD)):
            # Gain scales of zero leave the feed-forward torque alone.
            answer = await asyncio.wait_for(
                drive.set_position(position=math.nan, kp_scale=0.0, kd_scale=0.0, feedforward_torque=torque,
                                   watchdog_timeout=math.nan, query=True), 60.0)
            log.writerow([f"{index * PERIOD:.6f}", *(answer.values[column] for column in columns)])
    await drive.set_stop()
    line.close()


asyncio.run(main())
