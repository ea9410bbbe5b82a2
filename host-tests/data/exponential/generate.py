#!/usr/bin/env python3
"""Writes the fixtures beside it: exp(A h) - I and its input integrals to 50 digits, rounded to 17. Needs mpmath
(a Python package); tests read the files only and need no Python. How the integration under test works is not used here: one
Taylor series at a small step, squared back, with 90 spare digits.

Files: comments (#), then `matrix`, `inputs` and, for each `step`, `transition` (exp(A h) - I) and `integral k` (of
exp(A (h - s)) B (s / h)^k over s in [0, h]); each is followed by its rows. A, B and h are meant exactly as printed.
"""

from pathlib import Path

from mpmath import mp, mpf, matrix, eye, zeros, cos, pi, sqrt, factorial

mp.dps = 140
FOLDER = Path(__file__).parent
POWERS = 3
MODEL_STEPS = ["0.0001", "0.05", "1.025", "4.6", "20.5"]


def number(value):
    """A decimal, or what a computation gave, as the f64 that is nearest."""
    return mpf(float(mpf(value)))


def exponential(a):
    """exp(a) by a Taylor series of a / 2^k and k squarings; k squarings cost about 0.3 k digits of the spare ones."""
    squarings = 24
    small = a / mpf(2) ** squarings
    term, total = eye(a.rows), eye(a.rows)
    for k in range(1, 60):
        term = term * small / k
        total += term
    for _ in range(squarings):
        total = total * total
    return total


def flow(a, b, step):
    """exp(a h) - I and the input integrals, from one exponential of a bordered by b and a chain of integrators."""
    n, w = b.rows, b.cols
    bordered = zeros(n + POWERS * w)
    bordered[0:n, 0:n] = a * step
    bordered[0:n, n : n + w] = b * step
    for power in range(1, POWERS):
        for i in range(w):
            bordered[n + (power - 1) * w + i, n + power * w + i] = 1
    whole = exponential(bordered)
    integrals = [
        whole[0:n, n + power * w : n + (power + 1) * w] * factorial(power) for power in range(POWERS)
    ]
    return whole[0:n, 0:n] - eye(n), integrals


def rows(a):
    return [" ".join(format(float(a[i, j]), ".17g") for j in range(a.cols)) for i in range(a.rows)]


def write(name, comment, a, b, steps):
    lines = [f"# {comment}", "matrix", *rows(a), "inputs", *rows(b)]
    for step in steps:
        transition, integrals = flow(a, b, number(step))
        lines += [f"step {step}", "transition", *rows(transition)]
        for power, integral in enumerate(integrals):
            lines += [f"integral {power}", *rows(integral)]
    (FOLDER / f"{name}.txt").write_text("\n".join(lines) + "\n")


class Joint:
    """A closed joint, linear, in the relative coordinates of eqs 16 and 17; its matrices are found by probing: each
    coordinate is deflected alone with the carrier held at zero, and eqs 1-6 say how the bodies accelerate."""

    def __init__(self, planets, sun, rotor, planet, carrier, link, torsion, zeta):
        self.planets = planets
        self.own_sun, self.planet, self.stiffness, self.zeta = sun, planet, mpf(10) ** 8, zeta
        self.sun, self.carrier, self.link, self.torsion = sun + rotor, carrier, link, torsion
        self.omega = sqrt(self.stiffness * (1 / sun + 1 / planet))
        self.coordinates = planets + 1 + (1 if torsion else 0)

    def accelerations(self, x, v, sun=0, mesh=0):
        """Relative accelerations in dimensionless time for coordinates x and rates v; `sun` is a force on the sun and
        `mesh` one that the first sun mesh carries besides its own, both over K b_c."""
        n, k, w = self.planets, self.stiffness, self.omega
        reduced = self.own_sun * self.planet / (self.own_sun + self.planet)
        c_sun, c_ring = (2 * self.zeta * sqrt(k * m) for m in (reduced, self.planet))
        suns = [k * x[i] + c_sun * w * v[i] for i in range(n)]
        rings = [k * (x[n] - x[i]) + c_ring * w * (v[n] - v[i]) for i in range(n)]
        suns[0] += mesh * k
        wind = 0
        if self.torsion:
            geared = 4 * self.sun + n * self.planet + self.carrier
            damping = 2 * mpf("0.02") * sqrt(self.torsion * geared * self.link / (geared + self.link))
            wind = self.torsion * x[n + 1] + damping * w * v[n + 1]
        driven = (sun * k - sum(suns)) / self.sun
        planets = [(suns[i] - rings[i]) / self.planet for i in range(n)]
        carrier = (sum(suns) + sum(rings) - wind) / self.carrier
        relative = [driven - planet - carrier for planet in planets] + [driven - 2 * carrier]
        if self.torsion:
            relative.append(carrier - wind / self.link)
        return [a / w**2 for a in relative]

    def hamiltonian(self):
        """H of eq. 20, and as inputs a force that the first sun mesh takes off the joint and one on the sun."""
        size = self.coordinates
        k, c = zeros(size), zeros(size)
        for j in range(size):
            unit, still = [mpf(i == j) for i in range(size)], [mpf(0)] * size
            for i, value in enumerate(self.accelerations(unit, still)):
                k[i, j] = -value
            for i, value in enumerate(self.accelerations(still, unit)):
                c[i, j] = -value
        h, b = zeros(2 * size), zeros(2 * size, 2)
        h[0:size, 0:size] = h[size : 2 * size, size : 2 * size] = -c / 2
        h[0:size, size : 2 * size] = eye(size)
        h[size : 2 * size, 0:size] = c * c / 4 - k
        still = [mpf(0)] * size
        for i, value in enumerate(self.accelerations(still, still, mesh=1)):
            b[size + i, 0] = -value
        for i, value in enumerate(self.accelerations(still, still, sun=1)):
            b[size + i, 1] = value
        return h.apply(number), b.apply(number)


def paper(planets):
    carrier = (mpf("6.29") + planets * mpf("0.66")) / cos(mpf("24.6") * pi / 180) ** 2
    return Joint(planets, mpf("0.39"), 0, mpf("0.61"), carrier, 0, 0, mpf("0.05"))


def q1(planets):
    cosine = cos(pi / 9)
    sun_radius, lever = mpf("0.0075") * cosine, mpf("0.0225") * cosine
    carrier = mpf("0.15") + planets * mpf("0.05") / cosine**2
    torsion = 3 / (pi / 180 / 60) / lever**2
    link = mpf("0.15") / lever**2
    rotor = mpf("2.5e-4") / sun_radius**2
    return Joint(planets, mpf("0.02"), rotor, mpf("0.03"), carrier, link, torsion, mpf("0.05"))


def given(*values):
    return matrix([[number(value) for value in row] for row in values])


def jordan(size, rate, above):
    return given(*[[rate if i == j else above if j == i + 1 else 0 for j in range(size)] for i in range(size)])


def turned(a):
    """A symmetric and orthogonal change of four coordinates, exact in whole numbers and halves."""
    turn = eye(4) - matrix(4, 4).apply(lambda _: mpf(1) / 2)
    return (turn * a * turn).apply(number)


def spread(size, seed, scale, skew):
    """Whole numbers from a linear congruence, over `scale`; skew-symmetric or pulled to the stable side."""
    entries, a = seed, zeros(size)
    for i in range(size):
        for j in range(size):
            entries = (entries * 1103515245 + 12345) % 2**31
            a[i, j] = mpf(entries // 65536 % 201 - 100) / scale
    if skew:
        return ((a - a.T) / 2).apply(number)
    return (a - eye(size) * mpf(100 * size) / scale / 2).apply(number)


def ones(size):
    return matrix([[1, i + 1] for i in range(size)])


OTHERS = {
    "rotation": ("a rotation up to a thousand radians", given([0, 1], [-1, 0]), ["1e-9", "0.0001", "20.5", "1000"]),
    "stiff_oscillator": ("a stiff oscillator, norm 900", given([0, 1], [-900, "-0.01"]), ["0.001", "0.1", "1"]),
    "stiff_symmetric": ("decay rates 1 and 999", given([-500, 499], [499, -500]), ["0.001", "0.03", "1"]),
    "stiff_triangle": (
        "decay rates 1, 30 and 900, not normal",
        given([-1, 90, 0], [0, -30, 70], [0, 0, -900]),
        ["0.001", "0.1", "1"],
    ),
    "moler_van_loan": ("decay rates 1 and 17 that nearly cancel", given([-49, 24], [-64, 31]), ["0.01", "1", "8"]),
    "ward": ("Ward's matrix of norm 908", given([-131, 19, 18], [-390, 56, 54], [-387, 57, 52]), ["0.01", "1"]),
    "defective": ("one rate, four times", jordan(4, "-0.7", 1), ["0.0001", "3", "20.5"]),
    "defective_steep": ("one rate, three times, norm 301", jordan(3, -1, 300), ["0.001", "1", "3"]),
    "defective_hump": (
        "one rate, five times: grows a thousandfold and is gone",
        jordan(5, -100, 900),
        ["0.0625", "0.125", "0.25", "1"],
    ),
    "hidden_hump": (
        "as above without showing it: f64 doubling loses ten digits",
        turned(jordan(4, -30, 400)),
        ["0.0625", "0.25", "0.5", "1"],
    ),
    "nilpotent": ("the exponential is a polynomial", jordan(4, 0, 10), ["0.1", "1", "20.5"]),
    "nearly_defective": ("rates that differ by 1e-8", given(["-0.70000001", 1], [0, "-0.69999999"]), ["0.1", "3", "20.5"]),
    "nearly_defective_pair": ("rates -0.7 +- 1e-6", given(["-0.7", 1], ["1e-12", "-0.7"]), ["0.1", "3", "20.5"]),
    "nearly_critical": ("damped just beyond critically", given([0, 1], [-1, "-2.0000001"]), ["0.1", "5", "20.5"]),
    "hump": ("grows a hundredfold before it decays", given([-9, 980], [0, -11]), ["0.01", "0.1", "1"]),
    "growing": ("grows by 23 orders", given([1, 2], [3, 4]), ["0.0001", "1", "10"]),
    "skew": ("a rotation in five dimensions, norm up to 1000", spread(5, 7, mpf("0.25"), True), ["0.001", "0.1", "1"]),
    "stable": ("six dimensions, norm about 1000", spread(6, 3, mpf("0.625"), False), ["0.001", "0.1", "1"]),
}


def main():
    for planets in (3, 4, 5):
        for name, joint in (("paper", paper(planets)), ("q1", q1(planets))):
            comment = f"H of eq. 20, joint {name}, {planets} planets"
            write(f"{name}_{planets}", comment, *joint.hamiltonian(), MODEL_STEPS)
    for name, (comment, a, steps) in OTHERS.items():
        write(name, comment, a, ones(a.rows), steps)


if __name__ == "__main__":
    main()
