"""Client of a Dask scheduler for the command `joint` with `--dask`: runs the tasks of a folder on the workers.

`python -m lostmotion.dask ADDRESS FOLDER` submits every task of `FOLDER/list.json` that has no result, writes each result
into the folder, completely or not at all, and prints each step as a line of JSON. A task whose worker is lost is
submitted again. The workers need the package `lostmotion` of the same version, and no common disk.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

LOST_MAX = 20
"""Workers that a task may lose before it is taken for the reason."""
CONNECT_S = 10
"""Longest time to connect to the scheduler [s]."""


class TaskFailed(Exception):
    """A task ended with an exit code other than 0; the text is what it printed."""


class TaskKilled(Exception):
    """A signal ended a task, but not its worker."""


def run_task(text: str, digest: str) -> bytes:
    """Runs a list with one task in a process of its own, on a worker; returns the bytes of the result."""
    with tempfile.TemporaryDirectory(prefix="joint-task-") as folder:
        Path(folder, "list.json").write_text(text, encoding="utf-8")
        command = [sys.executable, "-m", "lostmotion", "task", folder, "--number", "0"]
        environment = {**os.environ, "NO_COLOR": "1"}
        ended = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, env=environment, check=False)
        if ended.returncode < 0:
            raise TaskKilled(f"signal {-ended.returncode}")
        if ended.returncode != 0:
            raise TaskFailed(ended.stderr.decode(errors="replace").strip())
        return Path(folder, digest + ".result").read_bytes()


def write(path: Path, data: bytes) -> None:
    """Writes a complete file, or leaves none."""
    temporary = path.with_name(f".{path.name}.joint-{os.getpid()}.tmp")
    with open(temporary, "wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    os.replace(temporary, path)


def say(**event: Any) -> None:
    """Prints a step."""
    print(json.dumps(event), flush=True)


def fail(message: str, help: str) -> int:
    """Prints the failure; returns the exit code."""
    say(failed={"message": message, "help": help})
    return 2


def connect(address: str) -> Any:
    """Client of the scheduler at an address or of a scheduler file."""
    from distributed import Client

    if os.path.isfile(address):
        return Client(scheduler_file=address, timeout=CONNECT_S)
    return Client(address, timeout=CONNECT_S)


def main(address: str, folder: Path) -> int:
    """Runs the tasks without a result; returns the exit code."""
    from distributed import as_completed
    from distributed.scheduler import KilledWorker

    whole = json.loads((folder / "list.json").read_text(encoding="utf-8"))
    tasks = {task["digest"]: task for task in whole["tasks"]}
    left = [digest for digest in tasks if not (folder / f"{digest}.result").exists()]
    try:
        client = connect(address)
    except (OSError, ValueError, TypeError) as error:
        reason = str(error) or type(error).__name__
        return fail(
            f"cannot connect to the Dask scheduler {address}: {reason}",
            "start it by `dask scheduler`, and name the address that it prints, such as tcp://10.0.0.5:8786",
        )
    with client:
        if not client.scheduler_info()["workers"]:
            say(remark=f"no worker is connected to {address}: the tasks wait for `dask worker {address}`")
        lost = dict.fromkeys(left, 0)
        owners: dict[str, str] = {}

        def submit(digest: str) -> Any:
            inputs = {name: whole["inputs"][name] for name in tasks[digest]["inputs"]}
            text = json.dumps({**whole, "inputs": inputs, "tasks": [tasks[digest]]})
            # A task that was lost needs another key: the scheduler remembers the lost one as failed.
            key = f"joint-{digest}-{os.getpid()}-{lost[digest]}"
            owners[key] = digest
            return client.submit(run_task, text, digest, key=key, pure=False)

        completed = as_completed([submit(digest) for digest in left])
        for future in completed:
            digest = owners[future.key]
            if future.status == "cancelled":
                return fail(f"the Dask scheduler {address} was lost", "start it again")
            error = future.exception()
            if error is None:
                write(folder / f"{digest}.result", future.result())
                say(done=None)
            elif isinstance(error, (KilledWorker, TaskKilled)) and lost[digest] < LOST_MAX:
                lost[digest] += 1
                completed.add(submit(digest))
            elif isinstance(error, (KilledWorker, TaskKilled)):
                number = list(tasks).index(digest)
                return fail(
                    f"task {number} has lost its worker {LOST_MAX} times: {error}",
                    f"see whether the workers have enough memory, and run it here: joint task {folder} --number {number}",
                )
            elif isinstance(error, TaskFailed):
                return fail(f"task {list(tasks).index(digest)} failed on a worker: {error}", "see the message of the task")
            else:
                return fail(
                    f"a worker cannot run tasks: {type(error).__name__}: {error}",
                    "install the same wheel lostmotion on every worker, with the Python and the distributed of the scheduler",
                )
            future.release()
    return 0


if __name__ == "__main__":
    # The workers import the functions by the module's name.
    from lostmotion import dask

    try:
        sys.exit(dask.main(sys.argv[1], Path(sys.argv[2])))
    except KeyboardInterrupt:
        sys.exit(130)
