"""Process that owns the threads of the compiled half."""

from __future__ import annotations

import os

_owner: int | None = None


def claim() -> None:
    """Claims the threads of the compiled half for this process.

    Threads do not survive a fork: a forked child that hands work to the threads of its parent would wait for ever.

    Raises:
        RuntimeError: in a forked child of the process that has the threads.
    """
    global _owner
    process = os.getpid()
    if _owner is None:
        _owner = process
    if _owner != process:
        raise RuntimeError(
            "lostmotion was in use before this process was forked, and its threads do not survive a fork: "
            'start processes by the method "spawn", as multiprocessing.get_context("spawn") does'
        )
