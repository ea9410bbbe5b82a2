"""Frames of a Damiao drive in its MIT mode, by hand."""

import can

#: State in the upper four bits of the first byte of an answer.
ENABLED, UNDER_VOLTAGE = 1, 9


class Damiao:
    """Damiao drive with identifier 1."""

    def __init__(self, port):
        self.bus = can.Bus(interface="slcan", channel=port, bitrate=1000000, sleep_after_open=0)

    def _ask(self, data):
        self.bus.send(can.Message(arbitration_id=1, data=data, is_extended_id=False))
        answer = self.bus.recv(timeout=30)
        assert answer is not None, "the drive does not answer"
        return answer.data[0] >> 4, int.from_bytes(answer.data[1:3], "big")

    def order(self, code):
        """Sends an order (0xFC enables, 0xFD disables, 0xFB clears a fault); returns state and position."""
        return self._ask(bytes([0xFF] * 7 + [code]))

    def impedance(self, position, stiffness, damping):
        """Sends an MIT frame. Position in bits of its field (16 bits), stiffness of 0 to 500 N m/rad, damping of 0 to
        5 N m s/rad, speed and torque zero. Returns state and position."""
        word = position
        for field, bits in [(0x800, 12), (round(stiffness / 500 * 0xFFF), 12), (round(damping / 5 * 0xFFF), 12),
                            (0x800, 12)]:
            word = word << bits | field
        return self._ask(word.to_bytes(8, "big"))

    def close(self):
        self.bus.shutdown()
