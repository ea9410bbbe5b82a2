"""Joints: sources, changes, errors with place and help."""

import pytest

import lostmotion
from lostmotion import Joint, JointError

C1 = {
    "name": "belt",
    "rated_output_torque_N_m": 20.0,
}


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
    sheet = dict(
        ratio=9,
        lost_motion_arcmin=15,
        stiffness_Nm_per_arcmin=1.8,
        rated_torque_Nm=8,
        rotor_inertia_kg_cm2=0.32,
        no_load_torque_Nm=0.05,
        efficiency=0.94,
    )
    joint = Joint.from_data_sheet("elbow", **sheet)
    assert joint.ratio == pytest.approx(9, rel=0.02) and joint.name == "elbow"
    with pytest.raises(JointError, match="efficiency"):
        Joint.from_data_sheet("elbow", **{**sheet, "efficiency": 3})


def test_figures_are_those_of_check():
    figures = Joint("q1").figures()
    assert figures and all(isinstance(key, str) for key in figures)
