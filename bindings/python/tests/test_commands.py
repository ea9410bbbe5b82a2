"""Identification, tests and logs as functions."""

import _thread
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import lostmotion
from lostmotion import Joint, JointError, identify, read_log, run_tests


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """Log of the recommended test, simulated."""
    path = tmp_path_factory.mktemp("log") / "virtual.csv"
    subprocess.run([sys.executable, "-m", "lostmotion", "identify", str(path), "--joint", "q1", "--simulate"], check=True)
    return path


def test_identified_gap_is_the_true_one(log):
    found = identify(log, "q1")
    gap = next(it for it in found.findings if "half_backlash" in it["key"] or it["key"].endswith("backlash_um"))
    print(f"\nidentified: {gap['value']:.2f} um, interval {gap['interval']}")
    assert found.record["crossings"] > 5 and "<html" in found.report_html
    assert found.joint is not None and found.joint.half_backlash_m == pytest.approx(40e-6, rel=0.1)


def test_columns_are_identified_as_their_file(log):
    columns = read_log(log)
    assert columns["motor_counts"].ndim == 1 and len(columns.time_s) == len(columns["motor_counts"])
    names = [name for name in columns if not name.startswith("~")]
    found = identify({name: columns[name] for name in names}, Joint("q1"))
    assert found.record["findings"] == identify(log, "q1").record["findings"]


def test_useless_log_is_refused_with_help():
    rows = 5000
    still = np.zeros(rows)
    columns = {"time_s": np.arange(rows) * 1e-4, "motor_counts": still, "output_counts": still, "motor_torque_N_m": still}
    with pytest.raises(JointError) as refused:
        identify(columns)
    assert refused.value.help
    with pytest.raises(JointError, match="none.csv"):
        identify("none.csv")
    with pytest.raises(JointError, match="--qasi-static"):
        identify("none.csv", qasi_static=True)


def test_columns_of_unequal_length_are_named():
    with pytest.raises(ValueError, match="time_s 10, motor_counts 9"):
        identify({"time_s": np.arange(10), "motor_counts": np.zeros(9)})
    with pytest.raises(ValueError, match=r"motor_counts has the shape \(\)"):
        identify({"time_s": np.arange(10), "motor_counts": 3})


def test_joint_of_a_slow_log_is_refused():
    with pytest.raises(TypeError, match="leave out joint="):
        identify("none.csv", "q1", quasi_static=True)
    with pytest.raises(TypeError, match="leave out changes="):
        identify("none.csv", changes={"half_backlash_um": 50}, quasi_static=True)


def test_map_of_several_joints_names_the_keyword(tmp_path):
    file = tmp_path / "map.toml"
    file.write_text('[joints.knee.columns]\nmotor_counts = "k"\n[joints.hip.columns]\nmotor_counts = "h"\n')
    for call in (lambda: identify("none.csv", map=str(file)), lambda: read_log("none.csv", map=file)):
        with pytest.raises(JointError) as refused:
            call()
        assert "knee" in refused.value.message and "map_joint=" in refused.value.help


def test_slow_log_gives_lost_motion():
    """Sweeps to and fro with a lost motion of 0.01 rad at the output."""
    time_s = np.arange(0, 120, 0.01)
    motor = 6 * 0.5 * (2 / np.pi) * np.arcsin(np.sin(2 * np.pi * time_s / 20))
    output, at = np.zeros_like(motor), 0.0
    for row, angle in enumerate(motor / 6):
        at = min(max(at, angle - 0.005), angle + 0.005)
        output[row] = at
    columns = {"time_s": time_s, "motor_angle_rad": motor, "output_angle_rad": output}
    found = identify(columns, quasi_static=True, gear_ratio=6)
    width = next(it for it in found.record["quantities"] if it["key"] == "width_by_direction_median")
    assert found.joint is None and width["value"] == pytest.approx(0.01, rel=0.05)


def test_bundled_test_runs_and_has_figures():
    result = run_tests("hil/t2.toml", seed=1)
    assert result.passed and result.record["tests"][0]["joint"] == "Q1"
    figures = result.figures()
    assert len(figures["controller"]) == len(figures["seed"]) > 1
    assert any(np.isfinite(values).all() for name, values in figures.items() if name not in ("seed", "controller"))
    run = next(iter(result.runs.values()))
    assert run["link_rad"].shape == run["wanted_rad"].shape == run.time_s.shape


def test_own_test_file_and_its_errors(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text('profile = "T2"\nduration_s = 4\n[assert]\nrms_gain_over_pid = ">= 1000"\n')
    assert not run_tests(file, seed=1, plant="core").passed
    file.write_text('profile = "T3000"\n')
    with pytest.raises(JointError) as refused:
        run_tests(file)
    assert refused.value.problems[0].line == 1


def test_ctrl_c_ends_a_test_and_the_next_one_runs():
    # A shell that starts this in the background has it ignore the signal.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.5, _thread.interrupt_main).start()
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        run_tests("hil/random-plants.toml", full=True)
    assert time.monotonic() - begin < 5
    assert run_tests("hil/t1.toml", seed=1).passed


def test_frames_have_the_columns():
    pandas = pytest.importorskip("pandas")
    plants = lostmotion.Plants("q1", n=2)
    frame = plants.step(0.1, steps=100, every=10).frame()
    assert isinstance(frame, pandas.DataFrame) and frame.shape == (10, 6)
    assert frame["gap_m"].shape == (10, 2) and frame.index.name == "time_s"
    assert lostmotion.Plant("q1").step(0.1, steps=10).frame().shape[0] == 10


def test_types_are_stated():
    assert (Path(lostmotion.__file__).parent / "py.typed").exists()
    pytest.importorskip("mypy")
    program = "import lostmotion\nplants = lostmotion.Plants('q1', n=2)\nreveal_type(plants.step(0.1, steps=3))\n"
    Path("typed.py").write_text(program)
    ended = subprocess.run([sys.executable, "-m", "mypy", "--strict", "typed.py"], capture_output=True, text=True)
    assert ended.returncode == 0 and "Columns" in ended.stdout, ended.stdout + ended.stderr
