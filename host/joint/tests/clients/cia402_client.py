"""CiA 402 by canopen 2.4.1: cia402_client.py PORT CONTROL EDS."""
import time

from canopen import Network
from canopen.profiles.p402 import BaseNode402
from twin import (HOT_MOTOR, LOST_MOTOR_ENCODER, MOVE, PORT, UNDER_VOLTAGE, WORDS, at_rest, check, check_move,
                  condition, wait_for)

(EDS,) = WORDS
NODE, MASTER = 1, 100
UNITS_PER_TURN = 360_000  # 6092h:01 after power-up
# Position demand, error code, heartbeat that the drive watches, positions by motor and output encoder.
TARGET, ERROR_CODE, CONSUMER, MOTOR, OUTPUT = 0x607A, 0x603F, 0x1016, 0x6064, 0x60E4
FOLLOWING_ERROR_WINDOW = 0x6065

network = Network()
network.connect(interface="slcan", channel=PORT, bitrate=1_000_000, sleep_after_open=0)
node = BaseNode402(NODE, EDS)
network.add_node(node)
node.sdo.RESPONSE_TIMEOUT = 20.0
# Waits of the client for the drive's state [s].
node.TIMEOUT_SWITCH_STATE_FINAL = node.TIMEOUT_SWITCH_STATE_SINGLE = 20.0
node.TIMEOUT_CHECK_TPDO = 20.0


def positions():
    """Angles by both encoders [turns of the output]."""
    return node.sdo[MOTOR].raw / UNITS_PER_TURN, node.sdo[OUTPUT][1].raw / UNITS_PER_TURN


def is_enabled():
    return node.sdo[0x6041].raw & 0x6F == 0x27


def enable():
    node.state = "OPERATION ENABLED"
    wait_for(is_enabled, "enabled")


def has_fault(code):
    return node.sdo[0x6041].raw & 0x4F == 0x08 and node.sdo[ERROR_CODE].raw == code


def clear():
    wait_for(lambda: node.state == "FAULT", "fault by PDO")
    node.state = "SWITCH ON DISABLED"
    wait_for(lambda: node.sdo[0x6041].raw & 0x4F == 0x40 and node.sdo[0x1001].raw == 0, "cleared")


# Connect: the boot-up of a reset node, its device type, and the PDOs as it has them.
node.nmt.state = "RESET"
node.nmt.wait_for_bootup(20)
check(node.sdo[0x1000].raw == 0x00020192, "a servo drive of CiA 402")
node.setup_402_state_machine()
node.nmt.state = "OPERATIONAL"
network.sync.start(0.01)
wait_for(lambda: node.state == "SWITCH ON DISABLED", "operational")

# Enable and move by cyclic positions in RPDO 2.
node.op_mode = "CYCLIC SYNCHRONOUS POSITION"
start, before = at_rest(positions), node.sdo[MOTOR].raw
enable()
for part in range(1, 101):
    node.rpdo[2]["Target position"].raw = before + round(part / 100 * MOVE * UNITS_PER_TURN)
    node.rpdo[2].transmit()
    time.sleep(0.01)
end = at_rest(positions)
check_move(end[0] - start[0], end[1] - start[1])

# Watchdog: the drive watches a heartbeat of this program, which ends.
beat = network.send_periodic(0x700 + MASTER, [5], 0.05)
node.sdo[CONSUMER][1].raw = MASTER << 16 | 2000
time.sleep(3.0)
check(is_enabled(), "the heartbeat is heard")
beat.stop()
wait_for(lambda: has_fault(0x8130), "watchdog expires")
node.sdo[CONSUMER][1].raw = 0
# The drive went to pre-operational by 1029h:01.
node.nmt.state = "OPERATIONAL"
clear()

# A fault that the client can cause: a following error.
enable()
node.sdo[FOLLOWING_ERROR_WINDOW].raw = 10
node.sdo[TARGET].raw = node.sdo[MOTOR].raw + 50_000
wait_for(lambda: has_fault(0x8611), "following error")
node.sdo[FOLLOWING_ERROR_WINDOW].raw = 0xFFFFFFFF
clear()

# Faults by the control socket.
for cause, code in [(UNDER_VOLTAGE, 0x3220), (HOT_MOTOR, 0x4310), (LOST_MOTOR_ENCODER, 0x7305)]:
    enable()
    with condition(*cause):
        wait_for(lambda: has_fault(code), f"{cause[0]}: {code:#x}")
    time.sleep(0.2)
    clear()

# Disable.
enable()
node.state = "SWITCH ON DISABLED"
wait_for(lambda: not is_enabled(), "disabled")
network.sync.stop()
network.disconnect()
