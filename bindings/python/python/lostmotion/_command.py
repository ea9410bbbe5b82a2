"""The command `joint`: the command line of the compiled library."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

from ._native import run_command

DATA = Path(__file__).parent / "data"
"""Folder of the tests that come with the package."""


def main() -> None:
    """Runs the command line of this process and ends it with the command's exit code."""
    # As for the compiled command: Ctrl-C ends the process, and the command replaces this while it runs.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    # The client of --dask and the tasks of --slurm run in this Python.
    os.environ.setdefault("JOINT_PYTHON", sys.executable)
    sys.exit(run_command(["joint", *sys.argv[1:]], str(DATA)))
