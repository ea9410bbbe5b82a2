"""The example of a Gymnasium environment: interface, gaps that change, repeatable episodes."""

import sys
from pathlib import Path

import numpy as np
from gymnasium.utils.env_checker import check_env

sys.path.insert(0, str(Path(__file__).parent.parent / "examples"))

from gap_env import GapEnv, proportional  # noqa: E402


def episode(env, seed):
    seen, facts = env.reset(seed=seed)
    observations, ended = [seen], False
    while not ended:
        seen, _, terminated, ended, _ = env.step(proportional(seen))
        assert not terminated
        observations.append(seen)
    return np.array(observations), facts["half_backlash_um"]


def test_environment_keeps_the_interface():
    check_env(GapEnv(seconds=0.1), skip_render_check=True)


def test_gap_changes_each_episode_and_repeats_by_seed():
    env = GapEnv(seconds=0.4)
    runs = [episode(env, seed) for seed in (1, 2, 3, 1)]
    widths = [width for _, width in runs]
    assert len(set(widths)) == 3 and widths[0] == widths[3]
    assert all(10.0 <= width <= 120.0 for width in widths)
    assert np.array_equal(runs[0][0], runs[3][0])


def test_spread_of_motor_against_link_grows_with_the_gap():
    spreads = []
    for half_backlash in (10.0, 120.0):
        env = GapEnv(half_backlash_um=(half_backlash, half_backlash), seconds=1.0)
        observations, _ = episode(env, 5)
        spreads.append(np.ptp(observations[:, 2]))
    assert spreads[1] > 3 * spreads[0]


def test_controller_reaches_the_target():
    observations, _ = episode(GapEnv(), 4)
    assert abs(observations[-1][0]) < 0.02
