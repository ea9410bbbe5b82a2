"""Torques of a reversal test, as docs/reference/identify.md recommends it, for a joint of 12 N m rated torque."""

RATED = 12.0  # [N m]
STRENGTHS = [1.0, 0.7, 0.45, 0.25]  # Several strengths tell gap and compliance apart.
REVERSALS, HOLD = 8, 0.12  # Reversals of each strength, and the time between two of them [s].


def torques(period):
    """Torque at the output for every sample [N m]."""
    for strength in STRENGTHS:
        for index in range(REVERSALS + 1):
            # Half the time first and last: the joint swings about its place.
            time = HOLD / 2 if index in (0, REVERSALS) else HOLD
            for _ in range(round(time / period)):
                yield strength * RATED * (-1) ** index
