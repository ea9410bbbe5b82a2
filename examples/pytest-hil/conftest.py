"""Fixture `twin`: joint behind a drive in simulated time, which advances with the frames of the client."""

import json
import os
import shutil
import signal
import socket
import subprocess
import time

import pytest

COMMAND = os.environ.get("JOINT") or "joint"
JOINT = shutil.which(COMMAND)


def pytest_sessionstart(session):
    """Ends the run before its first test if there is no command to test with."""
    if JOINT is None:
        raise pytest.UsageError(
            f"the command `{COMMAND}` was not found: build it by `cargo build --package joint` "
            "and set JOINT to target/debug/joint of the repository, or put it on the PATH")


class Twin:
    """Running `joint twin`, its port, and its control socket."""

    def __init__(self, folder, drive="moteus", joint="q1", seed=1, lockstep_ms=5.0):
        self.joint = joint
        self.step = 1e-3 * lockstep_ms  # Simulated time of a frame [s].
        self.home = None  # Angle of the drive when its joint first hung still [turns].
        self.port = str(folder / "port")
        self.log = folder / "twin.mcap"
        path = str(folder / "control")
        self.output = open(folder / "twin.txt", "w+")
        self.process = subprocess.Popen(
            [JOINT, "twin", str(joint), "--drive", drive, "--seed", str(seed), "--lockstep", str(lockstep_ms),
             "--link", self.port, "--control", path, "--log", str(self.log)],
            stdout=self.output, stderr=subprocess.STDOUT)
        self._control = socket.socket(socket.AF_UNIX)
        self._control.settimeout(30)
        end = time.monotonic() + 60
        while self._control.connect_ex(path) != 0:
            if self.process.poll() is not None or time.monotonic() > end:
                self.output.seek(0)
                pytest.fail(f"the twin did not start:\n{self.output.read()}")
            time.sleep(0.02)
        self._answers = self._control.makefile()

    def control(self, **command):
        """Sends a command to the control socket and returns the answer."""
        self._control.sendall(json.dumps(command).encode() + b"\n")
        answer = json.loads(self._answers.readline())
        assert "error" not in answer, answer
        return answer

    def status(self):
        """True state of the joint."""
        return self.control(status=True)["joints"][0]

    def close(self):
        self._control.close()
        self.process.send_signal(signal.SIGINT)
        try:
            code = self.process.wait(30)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        finally:
            self.output.close()
        return code


@pytest.fixture
def twin(request, tmp_path):
    """Twin of one test. Its options are an indirect parameter: dict(drive=..., joint=..., seed=...)."""
    twin = Twin(tmp_path, **getattr(request, "param", {}))
    yield twin
    twin.close()


@pytest.fixture(scope="session")
def geometry():
    """Function that returns figures of a joint from `joint check`."""

    def of(joint):
        check = subprocess.run([JOINT, "check", str(joint), "--json", "-"], capture_output=True, text=True, check=True)
        figures = json.loads(check.stdout)
        half_backlash = 1e6 * figures["meshes"][0]["half_backlash_m"][0]
        lost_motion = figures["output"]["lost_motion_arcmin"] / 60
        return {"half_backlash_um": half_backlash, "lost_motion_deg": lost_motion,
                "um_per_deg": half_backlash / lost_motion,
                "wind_up_deg": figures["output"]["wind_up_arcmin"] / 60,
                "rated_torque_N_m": figures["output"]["rated_torque_N_m"]}
    return of
