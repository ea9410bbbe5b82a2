"""A Gymnasium environment of a geared joint whose gap changes each episode.

The agent sees what a drive sees, the angle of the motor and of the link's encoder, and gives the motor's torque. The half-gap is
drawn anew at each reset, so that a policy has to find it, or to work without it.

    pip install lostmotion gymnasium
    python3 gap_env.py
"""

import gymnasium
import numpy as np

from lostmotion import Joint, Plant

TURN_RAD = 2 * np.pi


class GapEnv(gymnasium.Env):
    """Turn the link to a target angle and hold it there.

    Action: torque of the motor over its limit, shape (1,), held over a step.
    Observation, shape (5,): target less link angle [rad], speed of the link [rad/s], motor angle less ratio times link angle
    [rad], which lies between the flanks or on one; motor speed over ratio [rad/s]; torque of the step before, over its limit.
    Reward: minus the square of the angle error in hundredths of a radian, minus a small cost of torque.

    Args:
        joint: a preset, a joint file, or a dictionary.
        half_backlash_um: range from which the half-gap of every mesh is drawn, on a logarithmic scale [um].
        rate_Hz: steps of the environment per second; divides the joint's control rate.
        seconds: length of an episode [s].
    """

    metadata = {"render_modes": []}

    def __init__(self, joint="q1", half_backlash_um=(10.0, 120.0), rate_Hz=500, seconds=2.0):
        self.joint = Joint(joint) if isinstance(joint, str) else joint
        self.plant = Plant(self.joint)
        if self.plant.rate_Hz % rate_Hz != 0:
            raise ValueError(f"rate_Hz is {rate_Hz}, which does not divide the control rate {self.plant.rate_Hz} Hz")
        self.periods = self.plant.rate_Hz // rate_Hz
        self.steps_of_episode = int(seconds * rate_Hz)
        self.range_um = half_backlash_um
        self.ratio = self.joint.ratio
        self.limit_Nm = self.joint.torque_limit_N_m
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,), np.float32)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (5,), np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        low, high = np.log(self.range_um)
        half_backlash = float(np.exp(self.np_random.uniform(low, high)))
        self.plant = Plant(self.joint.changed({"half_backlash_um": half_backlash}))
        self.target = float(self.np_random.uniform(-0.3, 0.3))
        self.steps, self.torque = 0, 0.0
        return self._observe(), {"half_backlash_um": half_backlash}

    def step(self, action):
        self.torque = float(np.clip(np.asarray(action, np.float32).ravel()[0], -1.0, 1.0))
        self.plant.step(self.torque * self.limit_Nm, steps=self.periods, record=())
        self.steps += 1
        seen = self._observe()
        reward = -float((100.0 * seen[0]) ** 2) - 0.01 * self.torque**2
        return seen, reward, False, self.steps >= self.steps_of_episode, {}

    def _observe(self):
        state = self.plant.state()
        link, motor = float(state["link_angle_rad"][0]), float(state["motor_angle_rad"][0])
        speeds = [float(state[name][0]) for name in ("link_speed_rad_per_s", "motor_speed_rad_per_s")]
        seen = [self.target - link, speeds[0], motor - self.ratio * link, speeds[1] / self.ratio, self.torque]
        return np.array(seen, np.float32)


def proportional(seen):
    """A controller to begin with: a spring and a damper between motor and target."""
    error, link_speed, _, motor_speed, _ = seen
    return np.array([np.clip(12.0 * error - 0.4 * motor_speed, -1.0, 1.0)], np.float32)


if __name__ == "__main__":
    env = GapEnv()
    for episode in range(5):
        seen, facts = env.reset(seed=episode)
        total, ended = 0.0, False
        while not ended:
            seen, reward, _, ended, _ = env.step(proportional(seen))
            total += reward
        print(f"half-gap {facts['half_backlash_um']:6.1f} um, reward {total:10.1f}, last error {1e3 * seen[0]:7.2f} mrad")
