"""Joints."""

from __future__ import annotations

import json
import os
import tempfile
import warnings
from pathlib import Path
from typing import Any, Iterable, Iterator, Mapping, Union

import numpy as np

from . import _native
from ._errors import JointError
from ._process import claim

PRESETS: tuple[str, ...] = tuple(_native.PRESETS)
"""Names of the joints that come with the package."""


def toml_value(value: Any) -> str:
    """Value as TOML."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {toml_value(it)}" for key, it in value.items()) + " }"
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml_value(it) for it in value) + "]"
    return repr(value)


def toml_text(table: Mapping[str, Any], path: tuple[str, ...] = ()) -> str:
    """Dictionary as the text of a TOML file."""
    values = [f"{key} = {toml_value(it)}\n" for key, it in table.items() if not isinstance(it, Mapping)]
    tables = [toml_text(it, (*path, key)) for key, it in table.items() if isinstance(it, Mapping)]
    header = f"\n[{'.'.join(path)}]\n" if path and (values or not tables) else ""
    return header + "".join(values) + "".join(tables)


def assignments(changes: Mapping[str, Any] | None) -> list[str]:
    """Changes as `key=value`."""
    words = {key: it if isinstance(it, str) else toml_value(it) for key, it in (changes or {}).items()}
    return [f"{key}={word}" for key, word in words.items()]


class Joint:
    """Joint with its drive train, encoders and load.

    Args:
        source: name of a preset (`PRESETS`), path of a joint file, a `Joint`, or a dictionary with the keys of a joint
            file, each with its unit in the name: `{"name": ..., "mesh": {"half_backlash_um": 40, ...}, ...}`.
        changes: values to be changed, by key: `{"half_backlash_um": 60}`.

    Raises:
        JointError: with line, column and help of every problem.
    """

    native: _native.Joint

    def __init__(self, source: "JointLike" = "q1", changes: Mapping[str, Any] | None = None) -> None:
        if isinstance(source, Joint):
            self.native = source.native if not changes else source.changed(changes).native
        elif isinstance(source, Mapping):
            self.native = _native.Joint.parse("dictionary", toml_text(source), assignments(changes))
        elif not isinstance(source, (str, os.PathLike)):
            raise TypeError(f"a joint is a preset, a path, a dictionary or a Joint, not a {type(source).__name__}")
        else:
            self.native = _native.Joint.load(os.fspath(source), assignments(changes))

    @classmethod
    def from_text(cls, text: str, name: str = "text", changes: Mapping[str, Any] | None = None) -> "Joint":
        """Joint from the text of a joint file; `name` names the text in errors."""
        joint = cls.__new__(cls)
        joint.native = _native.Joint.parse(name, text, assignments(changes))
        return joint

    @classmethod
    def from_data_sheet(cls, name: str, **figures: Any) -> "Joint":
        """Joint from the figures of a data sheet, as `joint new` makes it; missing figures are named, never asked for.

        Odd figures that are usable, such as a link heavier than the motor can move, are Python warnings.

        Args:
            name: name of the joint.
            figures: options of `joint new`, with underscores: `ratio=9`, `lost_motion_arcmin=15`,
                `stiffness_Nm_per_arcmin=1.8` [N m/arcmin], `rated_torque_Nm=8`, `rotor_inertia_kg_cm2=0.32`,
                `no_load_torque_Nm=0.05`, `efficiency=0.94`; `equivalent=True` for a gear without known teeth.
        """
        figures.setdefault("no_measure", True)
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
            file = Path(folder, f"{Path(name).name}.toml")
            claim()
            printed = _native.joint_from_data_sheet([str(file), *options(figures)])
            joint = cls.from_text(file.read_text(encoding="utf-8"), file.stem)
        remarks = [line.removeprefix("note: ") for line in printed.splitlines() if line.startswith("note: ")]
        remarks += [f"line {line}: {message} ({remedy})" for line, message, remedy in joint.warnings]
        for remark in remarks:
            warnings.warn(f"{joint.name}: {remark}", stacklevel=2)
        return joint

    def changed(self, changes: Mapping[str, Any]) -> "Joint":
        """Joint with values changed, by key; an empty string leaves a key out."""
        return Joint.from_text(self.text, self.source, changes)

    def __getitem__(self, key: str) -> float | str:
        """Value of a key of the joint file, in the unit that the key names."""
        value = self.native.value(key)
        if value is None:
            raise KeyError(key)
        try:
            return float(value.replace("_", ""))
        except ValueError:
            return value.strip("\"'")

    def __contains__(self, key: object) -> bool:
        """Returns True if the joint file states the key."""
        try:
            return isinstance(key, str) and self.native.value(key) is not None
        except JointError:
            return False

    def __iter__(self) -> Iterator[str]:
        raise TypeError("a Joint is read by key: joint['half_backlash_um']")

    def __reduce__(self) -> tuple[Any, ...]:
        return Joint.from_text, (self.text, self.source)

    def figures(self) -> dict[str, Any]:
        """Derived figures, as `joint check --json` writes them: masses, frequencies, lost motion, wind-up, limits."""
        return dict(json.loads(_native.check(self.source, self.text)))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the joint file."""
        Path(path).write_text(self.text, encoding="utf-8")

    @property
    def source(self) -> str:
        """Path, or name of the preset."""
        return self.native.source

    @property
    def text(self) -> str:
        """Text of the joint file."""
        return self.native.text

    @property
    def name(self) -> str:
        """Name that the joint file states."""
        return self.native.name

    @property
    def planets(self) -> int:
        """Number of planets; 1 for an equivalent gear."""
        return self.native.planets

    @property
    def ratio(self) -> float:
        """Motor turns per turn of the link."""
        return self.native.ratio

    @property
    def control_rate_Hz(self) -> int:
        """Control rate [Hz]."""
        return self.native.control_rate

    @property
    def torque_limit_N_m(self) -> float:
        """Torque limit of the motor [N m]."""
        return self.native.torque_limit

    @property
    def half_backlash_m(self) -> float:
        """Half-backlash of each mesh of the sun [m]."""
        return self.native.half_backlash

    @property
    def counts_per_turn(self) -> tuple[int, int]:
        """Counts per turn of the motor's encoder and of the output's."""
        return self.native.counts_per_turn

    @property
    def warnings(self) -> list[tuple[int, str, str]]:
        """Odd values that are usable: line, message, help."""
        return self.native.warnings

    def __repr__(self) -> str:
        return repr(self.native)


JointLike = Union[str, "os.PathLike[str]", Mapping[str, Any], Joint]
"""Preset, path of a joint file, dictionary with the keys of a joint file, or joint."""


def as_joint(joint: JointLike) -> Joint:
    """Joint of a preset, a path, a dictionary, or the joint itself."""
    return joint if isinstance(joint, Joint) else Joint(joint)


def shared(joints: Iterable[JointLike]) -> list[Joint]:
    """Joints, one object for all of equal source and text, so that each is read and designed once."""
    read: dict[str, Joint] = {}
    known: dict[tuple[str, str], Joint] = {}
    found = []
    for it in joints:
        if isinstance(it, str):
            joint = read[it] if it in read else read.setdefault(it, Joint(it))
        else:
            joint = as_joint(it)
        found.append(known.setdefault((joint.source, joint.text), joint))
    return found


def options(keywords: Mapping[str, Any]) -> list[str]:
    """Keyword arguments as options of a command: True is a flag, a list repeats the option, None leaves it out."""
    words: list[str] = []
    for key, value in keywords.items():
        name = "--" + key.replace("_", "-")
        for one in value if isinstance(value, (list, tuple)) else [value]:
            if one is True:
                words.append(name)
            elif one is not None and one is not False:
                words.append(f"{name}={one}")
    return words
