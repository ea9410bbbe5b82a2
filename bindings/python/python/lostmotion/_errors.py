"""The exception of this package."""

from __future__ import annotations

from typing import NamedTuple


class Problem(NamedTuple):
    """Problem at a place of a file."""

    line: int
    """Line, from one."""
    column: int
    """Column, from one."""
    message: str
    """Problem in one sentence."""
    help: str | None
    """Remedy."""


class JointError(ValueError):
    """Refusal of a file, a key, a figure or a log.

    Attributes:
        message: cause.
        help: remedy, or None.
        problems: problems of a file, each with line and column; empty for other errors.
        exit_code: exit code of the command `joint` for this error.
    """

    message: str
    help: str | None
    problems: list[Problem]
    exit_code: int

    def __init__(
        self,
        message: str,
        help: str | None = None,
        problems: list[tuple[int, int, str, str | None]] = [],
        exit_code: int = 2,
    ) -> None:
        super().__init__(message, help, problems, exit_code)
        self.message = message
        self.help = help
        self.problems = [Problem(*problem) for problem in problems]
        self.exit_code = exit_code

    def __str__(self) -> str:
        lines = [self.message]
        lines += [f"  line {it.line}, column {it.column}: {it.message}" for it in self.problems]
        if self.help:
            lines += [f"  help: {line}" for line in self.help.splitlines()]
        return "\n".join(lines)
