"""Geared robot joints with backlash: plant, observer and compensation, with the bits of the board.

Arrays have a row per control period and, for many joints, a column per joint. Quantities are in SI; the unit ends each
name. Errors of files, keys and figures are `JointError`, with the place and the remedy.

    joint = Joint("q1")                          a preset, a file, a dictionary, a data sheet
    plants = Plants(joint, n=1000)               plants on all cores
    loop = closed_loop(plants, Controllers(joint, n=1000), Motion(position_rad))
    found = identify("log.csv", joint)           parameters from a recorded test
    result = run_tests("hil/t2.toml")            a test of observer and compensation
"""

from ._closed_loop import ClosedLoop, closed_loop
from ._columns import Columns
from ._commands import Identification, TestResult, identify, read_log, run_tests
from ._controllers import Controller, Controllers, Impedance, Motion, Observer, Observers
from ._errors import JointError, Problem
from ._joint import PRESETS, Joint
from ._native import __version__
from ._plants import Plant, Plants

__all__ = [
    "PRESETS",
    "ClosedLoop",
    "Columns",
    "Controller",
    "Controllers",
    "Identification",
    "Impedance",
    "Joint",
    "JointError",
    "Motion",
    "Observer",
    "Observers",
    "Plant",
    "Plants",
    "Problem",
    "TestResult",
    "__version__",
    "closed_loop",
    "identify",
    "read_log",
    "run_tests",
]
