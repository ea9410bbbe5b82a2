"""The command `joint` of the wheel, in a folder without sources and without Rust."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

JOINT = Path(sys.executable).with_name("joint")


def joint(*arguments, cwd, **keywords):
    environment = {**os.environ, "NO_COLOR": "1", "JOINT_INSTALL": "no"}
    return subprocess.run(
        [str(JOINT), *arguments], cwd=cwd, env=environment, capture_output=True, text=True, timeout=300, **keywords
    )


def test_machine_has_no_rust():
    assert shutil.which("cargo") is None and shutil.which("rustc") is None


def test_version_and_help(tmp_path):
    assert joint("--version", cwd=tmp_path).stdout.startswith("joint ")
    assert "Simulate a joint" in joint("--help", cwd=tmp_path).stdout
    refused = joint("hill", cwd=tmp_path)
    assert refused.returncode == 2 and "hil" in refused.stderr


def test_sim_works_at_once(tmp_path):
    ended = joint("sim", "q1", "--duration", "1", cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert list(tmp_path.glob("joint-out/sim/**/report.html"))


def test_bundled_test_runs_from_any_folder(tmp_path):
    ended = joint("hil", "hil/t2.toml", "--host", "--seed", "1", cwd=tmp_path)
    assert ended.returncode == 0, ended.stdout + ended.stderr


def test_hil_on_the_host_works_at_once(tmp_path):
    """Starts all tests; Ctrl-C ends them with 130."""
    environment = {**os.environ, "NO_COLOR": "1"}
    process = subprocess.Popen(
        [str(JOINT), "hil", "--host"], cwd=tmp_path, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    )
    time.sleep(3)
    assert process.poll() is None, process.communicate()[0]
    begin = time.monotonic()
    process.send_signal(signal.SIGINT)
    printed = process.communicate(timeout=60)[0].decode()
    assert process.returncode == 130 and "stopped by the user" in printed, printed
    assert time.monotonic() - begin < 10


@pytest.mark.parametrize(
    "arguments",
    [
        ["image", "q1", "--board", "nucleo-g474re"],
        ["flash", "q1", "--board", "nucleo-g474re"],
        ["hil"],
        ["hil", "q1"],
        ["hil", "hil/t2.toml"],
        ["library", "--target", "host"],
        ["paper"],
        ["bench"],
    ],
    ids=lambda it: "-".join(it[:2]),
)
def test_work_on_sources_is_refused_with_what_it_needs(arguments, tmp_path):
    ended = joint(*arguments, cwd=tmp_path)
    assert ended.returncode == 2, ended.stdout + ended.stderr
    assert "sources and Rust" in ended.stderr and "help:" in ended.stderr and "clone" in ended.stderr


def test_tables_and_presets_need_no_sources(tmp_path):
    assert joint("tables", "q1", "--out", "tables", cwd=tmp_path).returncode == 0
    assert (tmp_path / "tables" / "q1_tables.h").exists()
    assert joint("check", "s1", cwd=tmp_path).returncode == 0
    assert "moteus-r4" in joint("board", "list", cwd=tmp_path).stdout
    assert joint("board", "check", "moteus-r4", cwd=tmp_path).returncode == 0


def test_start_takes_no_longer_than_a_blink(tmp_path):
    begin = time.monotonic()
    joint("--version", cwd=tmp_path)
    seconds = time.monotonic() - begin
    print(f"\njoint --version: {seconds:.2f} s")
    assert seconds < 2
