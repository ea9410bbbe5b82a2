"""Runs of a sweep and of tests on a Dask cluster whose workers are killed, and in a SLURM array, against one process.

`python cluster.py dask|slurm FOLDER` prints each figure, and fails if one byte differs. `cargo test -p python-bindings --test
cluster -- --ignored --nocapture` makes the environment and runs both. SLURM: apt-get install slurm-wlm.
"""

import json
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

WORKERS = 2
KILL_EVERY_S = (4.0, 8.0)
"""Time between two kills of a worker, from and to [s]."""
JOINTS = int(os.environ.get("CLUSTER_JOINTS", "10000"))
SEEDS = os.environ.get("CLUSTER_SEEDS", "1-12")
GRID = ["sweep", "paper", "--vary", f"half_backlash_um=1:{1 + 0.01 * (JOINTS - 1):.2f}:0.01", "--duration", "0.005"]
TESTS = ["hil", "hil/never-worse.toml", "--host", "--seed", SEEDS]


def joint(*words):
    """Runs the command to its end; returns its seconds and what it printed."""
    begin = time.monotonic()
    ended = subprocess.run(
        [sys.executable, "-m", "lostmotion", *words], env={**os.environ, "NO_COLOR": "1"}, capture_output=True, text=True
    )
    # Exit code 1: a bound of the test does not hold, as may be with these seeds.
    assert ended.returncode in (0, 1), ended.stdout + ended.stderr
    return time.monotonic() - begin, ended.stdout + ended.stderr


def sweep_files(folder):
    return {name: (folder / name).read_bytes() for name in ("points.csv", "report.html", "sweep.json")}


def test_files(folder):
    """Record without the entries that differ between two runs of one process, and the logs."""
    record = json.loads((folder / "record.json").read_text())
    for part in [record, *record["tests"]]:
        for key in ("date", "seconds"):
            part.pop(key, None)
    logs = {path.name: path.read_bytes() for path in sorted((folder / "runs").iterdir())}
    return {"record.json": json.dumps(record, indent=1).encode(), **logs}


def assert_equal(what, found, expected):
    assert sorted(found) == sorted(expected), f"{what}: {sorted(found)} {sorted(expected)}"
    for name in expected:
        assert found[name] == expected[name], f"{what}: {name} differs"
    print(f"{what}: {len(expected)} files equal in {sum(map(len, expected.values()))} bytes", flush=True)


class Cluster:
    """A scheduler and its workers, each a process of its own."""

    def __init__(self, folder):
        self.folder = folder
        self.file = folder / "scheduler.json"
        self.killed = 0
        module = ["-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
        self.scheduler = self.start([*module, "--scheduler-file", str(self.file)], "scheduler")
        while not self.file.exists():
            time.sleep(0.1)
        self.workers = [self.worker() for _ in range(WORKERS)]

    def start(self, words, name):
        log = open(self.folder / f"{name}.log", "ab")
        return subprocess.Popen([sys.executable, *words], stdout=log, stderr=log, cwd=self.folder)

    def worker(self):
        module = ["-m", "distributed.cli.dask_worker", "--scheduler-file", str(self.file), "--host", "127.0.0.1"]
        return self.start([*module, "--nthreads", "1", "--no-nanny", "--no-dashboard"], "worker")

    def kill_one(self):
        """Kills a worker by SIGKILL and starts another."""
        place = random.randrange(len(self.workers))
        self.workers[place].send_signal(signal.SIGKILL)
        self.workers[place].wait()
        self.workers[place] = self.worker()
        self.killed += 1

    def close(self):
        for process in [*self.workers, self.scheduler]:
            process.kill()
            process.wait()


def on_dask(cluster, words, kill):
    """Runs a command on the cluster while workers are killed; returns its seconds."""
    command = [sys.executable, "-m", "lostmotion", *words, "--dask", str(cluster.file)]
    begin = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    due = begin + random.uniform(*KILL_EVERY_S)
    while process.poll() is None:
        if kill and time.monotonic() > due:
            cluster.kill_one()
            due = time.monotonic() + random.uniform(*KILL_EVERY_S)
        time.sleep(0.02)
    printed = process.communicate()[0]
    assert process.returncode in (0, 1), printed
    return time.monotonic() - begin


def dask(folder):
    random.seed(1)
    one, tests = folder / "one", folder / "one-tests"
    seconds, _ = joint(*GRID, "--out", str(one))
    print(f"one process: {JOINTS} joints in {seconds:.1f} s", flush=True)
    seconds, _ = joint(*TESTS, "--out", str(tests))
    print(f"one process: seeds {SEEDS} in {seconds:.1f} s", flush=True)
    cluster = Cluster(folder)
    try:
        calm = on_dask(cluster, [*GRID, "--out", str(folder / "calm")], False)
        print(f"dask, {WORKERS} workers: {JOINTS} joints in {calm:.1f} s", flush=True)
        assert_equal("dask, no worker killed", sweep_files(folder / "calm"), sweep_files(one))
        killed = on_dask(cluster, [*GRID, "--out", str(folder / "killed")], True)
        print(f"dask, {cluster.killed} workers killed by -9: {JOINTS} joints in {killed:.1f} s", flush=True)
        assert cluster.killed > 0
        print(f"a lost worker costs {(killed - calm) / cluster.killed:.1f} s, its restart included", flush=True)
        assert_equal("dask, workers killed", sweep_files(folder / "killed"), sweep_files(one))
        before = cluster.killed
        seconds = on_dask(cluster, [*TESTS, "--out", str(folder / "tests")], True)
        print(f"dask, {cluster.killed - before} workers killed: seeds {SEEDS} in {seconds:.1f} s", flush=True)
        assert_equal("dask, tests", test_files(folder / "tests"), test_files(tests))
    finally:
        cluster.close()


SLURM = """ClusterName=joint
SlurmctldHost={host}
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SlurmctldPort={port}
SlurmdPort={node_port}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/ctld.pid
SlurmdPidFile={folder}/d.pid
SlurmctldLogFile={folder}/ctld.log
SlurmdLogFile={folder}/d.log
SchedulerType=sched/backfill
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_port():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


def slurm(folder):
    if shutil.which("slurmctld") is None or shutil.which("slurmd") is None:
        sys.exit("SLURM is missing: apt-get install slurm-wlm")
    random.seed(1)
    one, tests = folder / "slurm-one", folder / "slurm-one-tests"
    joint(*GRID, "--out", str(one))
    joint(*TESTS, "--out", str(tests))
    conf, place = folder / "slurm.conf", folder / "slurm"
    (place / "state").mkdir(parents=True, exist_ok=True)
    (place / "spool").mkdir(exist_ok=True)
    host = socket.gethostname().split(".")[0]
    text = SLURM.format(host=host, folder=place, port=free_port(), node_port=free_port(), cpus=os.cpu_count())
    conf.write_text(text)
    os.environ["SLURM_CONF"] = str(conf)
    log = open(folder / "slurm-daemons.log", "ab")
    daemons = [
        subprocess.Popen([name, "-D", "-f", str(conf)], stdout=log, stderr=log) for name in ("slurmctld", "slurmd")
    ]
    try:
        wait_for(lambda: "idle" in output("sinfo", "-h", "-o", "%t"), 60, "the node is idle")
        for words, out, collect, read, expected in [
            (GRID, folder / "array", [], sweep_files, one),
            (TESTS, folder / "array-tests", ["--resume"], test_files, tests),
        ]:
            begin = time.monotonic()
            joint(*words, "--out", str(out), "--slurm")
            killed = submit_and_kill(out)
            seconds = time.monotonic() - begin
            left = len(json.loads((out / "tasks/list.json").read_text())["tasks"]) - len(list((out / "tasks").glob("*.result")))
            print(f"slurm, {killed} tasks killed by -9: array in {seconds:.1f} s, {left} tasks left", flush=True)
            _, printed = joint(*words, "--out", str(out), *collect)
            assert "continuing:" in printed, printed
            assert_equal(f"slurm, {words[0]}", read(out), read(expected))
    finally:
        for daemon in reversed(daemons):
            daemon.terminate()
            daemon.wait()


def submit_and_kill(out):
    """Submits the script and kills some programs of its tasks; returns how many."""
    output("sbatch", str(out / "tasks/slurm.sh"))
    killed, due = 0, time.monotonic() + 2
    while output("squeue", "-h"):
        if time.monotonic() > due:
            found = output("pgrep", "-f", f"task {out}/tasks --number", check=False).split()
            if found:
                try:
                    os.kill(int(random.choice(found)), signal.SIGKILL)
                    killed += 1
                except ProcessLookupError:
                    pass
            due = time.monotonic() + 3
        time.sleep(0.2)
    return killed


def output(*words, check=True):
    return subprocess.run(words, check=check, capture_output=True, text=True).stdout.strip()


def wait_for(condition, seconds, what):
    end = time.monotonic() + seconds
    while True:
        try:
            if condition():
                return
        except subprocess.CalledProcessError:
            pass
        assert time.monotonic() < end, what
        time.sleep(0.5)


if __name__ == "__main__":
    {"dask": dask, "slurm": slurm}[sys.argv[1]](Path(sys.argv[2]))
