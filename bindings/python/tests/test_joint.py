"""Joints: sources, changes, errors with place and help."""

import os
import subprocess
import sys
import time

import numpy as np
import pytest

import lostmotion
from lostmotion import Controllers, Joint, JointError, Plant, Plants
from lostmotion._joint import toml_text


SHEET = dict(
    ratio=9,
    lost_motion_arcmin=15,
    stiffness_Nm_per_arcmin=1.8,
    rated_torque_Nm=8,
    rotor_inertia_kg_cm2=0.32,
    no_load_torque_Nm=0.05,
    efficiency=0.94,
)


def test_preset_has_its_figures():
    joint = Joint("q1")
    assert (joint.name, joint.planets, joint.ratio) == ("Q1", 3, 6.0)
    assert joint["half_backlash_um"] == 40.0 and joint.half_backlash_m == pytest.approx(40e-6)
    assert joint.control_rate_Hz == 10_000 and joint.counts_per_turn[0] > 1000


def test_changed_value_is_read_like_any_other():
    joint = Joint("q1", {"half_backlash_um": 60})
    assert joint.half_backlash_m == pytest.approx(60e-6)
    assert joint.changed({"half_backlash_um": 55}).half_backlash_m == pytest.approx(55e-6)
    with pytest.raises(JointError, match="half_backlsh_um") as refused:
        Joint("q1", {"half_backlsh_um": 60})
    assert "half_backlash_um" in refused.value.help


def test_problems_have_place_and_help():
    text = Joint("q1").text.replace("planets = 3", "planets = 7")
    line = 1 + text[: text.index("planets = 7")].count("\n")
    with pytest.raises(JointError) as refused:
        Joint.from_text(text, "my_joint.toml")
    error = refused.value
    assert any(problem.line == line and problem.help for problem in error.problems), error.problems
    assert error.exit_code == 2 and "my_joint.toml" in error.message and f"line {line}" in str(error)
    assert isinstance(error, ValueError)


def test_missing_file_names_the_presets():
    with pytest.raises(JointError) as refused:
        Joint("none.toml")
    assert "none.toml" in refused.value.message and "q1" in refused.value.help


def test_dictionary_is_a_joint_file():
    import sys

    if sys.version_info < (3, 11):
        pytest.skip("tomllib")
    import tomllib

    for name in lostmotion.PRESETS:
        joint = Joint(name)
        same = Joint(tomllib.loads(joint.text))
        assert (same.name, same.ratio, same.half_backlash_m) == (joint.name, joint.ratio, joint.half_backlash_m)
    with pytest.raises(JointError, match="dictionary"):
        Joint({"name": "nothing"})


def test_data_sheet_makes_a_joint():
    sheet = SHEET
    joint = Joint.from_data_sheet("elbow", **sheet)
    assert joint.ratio == pytest.approx(9, rel=0.02) and joint.name == "elbow"
    with pytest.raises(JointError, match="efficiency"):
        Joint.from_data_sheet("elbow", **{**sheet, "efficiency": 3})


def test_figures_are_those_of_check():
    figures = Joint("q1").figures()
    gap, wider = (it["output"]["lost_motion_arcmin"] for it in (figures, Joint("q1", {"half_backlash_um": 80}).figures()))
    assert wider == pytest.approx(2 * gap, rel=1e-6)


def test_equal_joints_are_read_and_designed_once():
    begin = time.monotonic()
    assert len(Plants("q1", n=1000)) == 1000
    one = time.monotonic() - begin
    begin = time.monotonic()
    plants = Plants(["q1"] * 500 + [Joint("q1")] * 250 + [Joint("q1") for _ in range(250)])
    many = time.monotonic() - begin
    assert len(plants) == 1000 and many < 20 * one + 1, f"{one:.2f} s for one joint, {many:.2f} s for equal ones"


def test_every_form_of_a_joint_is_accepted(tmp_path):
    file = tmp_path / "mine.toml"
    Joint("q1").save(file)
    expected = Plant("q1").tables()
    for form in (file, str(file), Joint("q1"), Joint(Joint("q1"))):
        assert Plant(form).tables() == expected
        assert Plants(form, n=2).tables(1) == Plants([form, form]).tables(1) == expected
    with pytest.raises(TypeError, match="not a int"):
        Joint(3)


def test_keys_of_a_joint_are_looked_up():
    joint = Joint("q1")
    assert "half_backlash_um" in joint and "half_backlsh_um" not in joint and 3 not in joint


def test_numbers_of_numpy_are_toml():
    values = {"a": np.bool_(True), "b": np.float64(1.5), "c": np.int64(3), "d": np.array([1.0, 2.0])}
    assert toml_text(values) == "a = true\nb = 1.5\nc = 3\nd = [1.0, 2.0]\n"


def test_changed_value_names_its_origin():
    text = Joint("q1", {"half_backlash_um": 60}).text
    assert "# set in Python" in text and "command line" not in text


def test_help_of_a_refused_rate_is_in_words_of_python():
    for kind in (Plants, Controllers):
        with pytest.raises(JointError) as refused:
            kind("q1", n=1, rate=300)
        assert "rate=" in refused.value.help and "--" not in refused.value.help


def test_missing_figure_of_a_data_sheet_is_named_and_not_asked_for():
    """With a terminal as standard input, the compiled command would ask."""
    terminal, of_child = os.openpty()
    program = "import lostmotion\ntry: lostmotion.Joint.from_data_sheet('elbow', ratio=9)\nexcept lostmotion.JointError as e: print(e)"
    ended = subprocess.run([sys.executable, "-c", program], stdin=of_child, capture_output=True, text=True, timeout=60)
    os.close(terminal)
    os.close(of_child)
    assert "lacks" in ended.stdout and "terminal" not in ended.stdout, ended


def test_remarks_on_a_data_sheet_are_warnings():
    sheet = dict(SHEET, motor_peak_torque_Nm=0.1)
    with pytest.warns(UserWarning, match="elbow"):
        joint = Joint.from_data_sheet("some/folder/elbow", **sheet)
    assert joint.name == "elbow"
