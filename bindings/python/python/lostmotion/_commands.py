"""Identification, tests and logs: commands of `joint` as functions."""

from __future__ import annotations

import csv
import json
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping

from . import _native
from ._columns import Columns
from ._command import DATA
from ._joint import Joint, JointLike, as_joint, assignments, options
from ._process import claim


@dataclass
class Identification:
    """Result of an identification.

    Attributes:
        record: the record, as `findings.json` of `joint identify`.
        joint: joint with the identified values; None for a slow log.
        report_html: the report.
    """

    record: dict[str, Any]
    joint: Joint | None
    report_html: str

    @property
    def findings(self) -> list[dict[str, Any]]:
        """Parameters, each with its 95 % interval in the unit of its key, or the reason for a missing one."""
        return list(self.record.get("findings", []))


def identify(
    log: str | os.PathLike[str] | Mapping[str, Any],
    joint: JointLike | None = None,
    *,
    changes: Mapping[str, Any] | None = None,
    **keywords: Any,
) -> Identification:
    """Estimates a joint's parameters from a recorded test, as `joint identify`.

    Args:
        log: path of a log (CSV, MCAP), or columns by name: `time_s`, `motor_counts` or `motor_angle_rad`,
            `output_counts` or `output_angle_rad`, `motor_torque_N_m`; arrays of the shape (rows,).
        joint: joint that gives teeth, levers and inertias; q1 if left out.
        changes: values of the joint to be changed first, by key.
        keywords: further options of the command, with underscores: `quasi_static=True` (without `joint` and `changes`),
            `gear_ratio=6`, `output_locked=True`, `map="moteus"`, `map_joint="knee"` for a map of several joints,
            `column=["motor_counts=pos_raw"]`, `unit=["motor_angle=turns"]`.

    Raises:
        JointError: if the log determines nothing; says which rows and what to record.
        KeyboardInterrupt: after Ctrl-C, at once.
    """
    claim()
    quasi_static = keywords.get("quasi_static")
    for unused, value in (("joint", joint), ("changes", changes)):
        if quasi_static and value is not None:
            raise TypeError(f"quasi_static=True reads angles alone: leave out {unused}=, and pass gear_ratio=")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = Path(name)
        if isinstance(log, Mapping):
            path = folder / "columns.csv"
            _write_columns(path, log)
        else:
            path = Path(log)
        words = [os.fspath(path), f"--out={folder / 'out'}", *options(keywords)]
        if not quasi_static:
            as_joint("q1" if joint is None else joint).save(folder / "joint.toml")
            words += [f"--joint={folder / 'joint.toml'}", *(f"--set={it}" for it in assignments(changes))]
        _native.identify(words)
        out = folder / "out"
        patched = out / "joint.toml"
        found = Joint.from_text(patched.read_text(encoding="utf-8"), "identified") if patched.exists() else None
        report = (out / "report.html").read_text(encoding="utf-8")
        return Identification(json.loads((out / "findings.json").read_text(encoding="utf-8")), found, report)


def _write_columns(path: Path, columns: Mapping[str, Any]) -> None:
    import numpy as np

    shapes = {name: np.shape(values) for name, values in columns.items()}
    for name, shape in shapes.items():
        if len(shape) != 1:
            raise ValueError(f"column {name} has the shape {shape}, not (rows,)")
    if len(set(shapes.values())) > 1:
        listed = ", ".join(f"{name} {rows}" for name, (rows,) in shapes.items())
        raise ValueError(f"the columns have different numbers of rows: {listed}")
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*(list(values) for values in columns.values()), strict=True))


@dataclass
class TestResult:
    """Result of a test file, or of a folder of them.

    Attributes:
        passed: True if every assertion held.
        record: the record, as `record.json` of `joint hil`.
        report_html: the report.
        runs: histories of the shown runs by name of the log: wanted and true motion, estimates and torques, 1000 rows a
            second.
    """

    __test__ = False

    passed: bool
    record: dict[str, Any]
    report_html: str
    runs: dict[str, Columns]

    def figures(self, test: int = 0) -> Columns:
        """Figures of every run of a test: an array per figure, and the seeds and controllers, each of the shape (runs,);
        NaN where a run does not have the figure."""
        import numpy as np

        runs = self.record["tests"][test]["runs"]
        names = list(dict.fromkeys(name for run in runs for name in run["figures"]))
        columns = {"seed": np.array([run["seed"] for run in runs]), "controller": np.array([run["controller"] for run in runs])}
        for name in names:
            columns[name] = np.array([_number(run["figures"].get(name)) for run in runs])
        return Columns(columns)


def _number(value: Any) -> float:
    return float("nan") if value is None else float(value)


def run_tests(
    path: str | os.PathLike[str],
    *,
    seed: int | str | None = None,
    plant: str = "reference",
    full: bool = False,
) -> TestResult:
    """Runs a test file of observer and compensation, or a folder of them, as `joint hil --host`.

    Args:
        path: path of a test file or folder; `hil/NAME.toml` also finds the tests that come with the package.
        seed: seed, or a range such as "1-20", in place of the file's.
        plant: "reference" (independent float64 model) or "core" (the board's step).
        full: True runs the full lists of seeds.

    Raises:
        JointError: with the place, if a file cannot be used.
        KeyboardInterrupt: after Ctrl-C, at once.
    """
    claim()
    file = Path(path)
    if not file.exists() and file.parts[:1] == ("hil",):
        file = DATA / file
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        out = Path(name) / "out"
        passed = _native.run_tests(os.fspath(file), None if seed is None else str(seed), plant, full, os.fspath(out))
        record = json.loads((out / "record.json").read_text(encoding="utf-8"))
        logs = sorted((out / "runs").glob("*.mcap"))
        runs = {log.stem: read_log(log, topic="/joint/trial") for log in logs}
        return TestResult(passed, record, (out / "report.html").read_text(encoding="utf-8"), runs)


def read_log(
    path: str | os.PathLike[str],
    *,
    topic: str | None = None,
    map: str | os.PathLike[str] | None = None,
    map_joint: str | None = None,
    ratio: float = 1.0,
) -> Columns:
    """Reads a log (CSV or MCAP) as columns of numbers.

    Args:
        path: path of the log.
        topic: topic of an MCAP log whose fields are read under their own names; without it the topic with motor, output
            and torque is read, in SI.
        map: names and units of a maker's columns: a file, or one of the maps of `joint identify --map`.
        map_joint: joint of a map of several joints.
        ratio: motor turns per turn of the output, for columns that are given at the output.

    Returns:
        float64 arrays of the shape (rows,); NaN where a value is missing.
    """
    found = _native.log_columns(os.fspath(path), topic, None if map is None else os.fspath(map), map_joint, ratio)
    columns = dict(found)
    return Columns(columns, columns.get("time_s"))
