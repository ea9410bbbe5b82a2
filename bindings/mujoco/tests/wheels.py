"""Steps an exported joint in MuJoCo: wheels.py CHECK PLUGIN MODEL [...]; prints figures, fails on a difference in bits."""

import copy
import os
import pickle
import re
import subprocess
import sys
import time

import mujoco
import numpy as np

MOTOR_ANGLE, MOTOR_SPEED, LINK_ANGLE, LINK_SPEED, GAP = 0, 1, 2, 3, 4
WIND_UP, MOTOR_TORQUE, LINK_TORQUE = 6, 9, 10
# With a controller, one number more for each:
COMMANDED_TORQUE, ESTIMATED_GAP, GAP_VALID, HALF_BACKLASH, HALF_BACKLASH_VALID = 11, 12, 13, 14, 15
ESTIMATED_CONTACT, CONTACT_VALID, ESTIMATED_LINK_ANGLE, TRUST = 16, 17, 18, 21
POSITION = '<config key="controller" value="position"/>'
IMPEDANCE = (
    '<config key="controller" value="impedance"/><config key="stiffness" value="150"/><config key="damping" value="5"/>'
)
STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS


def load(text, timestep=None, integrator=None):
    """Model with another step [s] or integrator."""
    if timestep is not None:
        text = re.sub(r'timestep="[^"]*"', f'timestep="{timestep}"', text)
    if integrator is not None:
        text = re.sub(r'integrator="[^"]*"', f'integrator="{integrator}"', text)
    return mujoco.MjModel.from_xml_string(text)


def with_law(text, config=POSITION):
    """Model whose instance has these keys; the control has no range."""
    text = re.sub(r'<instance name="joint">.*?</instance>', f'<instance name="joint">{config}</instance>', text, flags=re.S)
    return re.sub(r'ctrllimited="true" ctrlrange="[^"]*"', "", text)


def state_of(model, data):
    state = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, state, STATE)
    return state


def accuracy(text, reference):
    """Errors against rows of: command, motor angle, link angle, gap, link speed; for each integrator and step."""
    rows = np.loadtxt(reference, delimiter=",")
    timestep = float(open(reference).readline().split()[1])
    for integrator in ("Euler", "implicitfast", "implicit"):
        model = load(text, timestep, integrator)
        data = mujoco.MjData(model)
        found = np.empty((len(rows), 3))
        seen = np.empty(len(rows))
        for row, values in enumerate(rows):
            data.ctrl[0] = values[0]
            seen[row] = data.qpos[0]
            mujoco.mj_step(model, data)
            found[row] = data.sensordata[[MOTOR_ANGLE, LINK_ANGLE, GAP]]
        ranges = np.ptp(rows[:, 1:4], axis=0)
        errors = np.abs(found - rows[:, 1:4]).max(axis=0) / ranges
        mean = np.sqrt(np.mean((found - rows[:, 1:4]) ** 2, axis=0)) / ranges
        qpos = np.abs(seen - rows[:, 2]).max() / ranges[1]
        print(
            f"accuracy {integrator} {timestep} link {errors[1]:.6f} motor {errors[0]:.6f} motor_rms {mean[0]:.6f} "
            f"gap_rms {mean[2]:.6f} qpos {qpos:.6f}"
        )


def energy(text, rotor_inertia, link_inertia, stiffness):
    """Largest growth of the energy of rotor, link and compliance after the torque has ended, over its largest value."""
    for timestep in (0.0005, 0.001, 0.002):
        model = load(text, timestep, "Euler")
        data = mujoco.MjData(model)
        energies = []
        for step in range(int(3.0 / timestep)):
            t = step * timestep
            data.ctrl[0] = 0.8 * np.sign(np.sin(2 * np.pi * 6 * t)) if t < 0.5 else 0.0
            mujoco.mj_step(model, data)
            if t > 0.52:
                motor, link, wind_up = data.sensordata[[MOTOR_SPEED, LINK_SPEED, WIND_UP]]
                kinetic = 0.5 * rotor_inertia * motor**2 + 0.5 * link_inertia * link**2
                energies.append(kinetic + 0.5 * stiffness * wind_up**2)
        # The energy that the teeth store comes back: compare peaks of windows of 50 ms.
        window = int(0.05 / timestep)
        peaks = [max(energies[at : at + window]) for at in range(0, len(energies) - window, window)]
        growth = max(later - earlier for earlier, later in zip(peaks, peaks[1:]))
        print(f"energy {timestep} growth {growth / max(peaks):.6f} left {peaks[-1] / peaks[0]:.4f}")


def chain(text, joints):
    """Model of several arms of six joints, one instance each; without plug-in, the same with motors."""
    plugin = re.search(r'plugin plugin="([^"]*)"', text).group(1)
    instances = "".join(f'<instance name="i{n}"/>' for n in range(joints))
    bodies, actuators, motors = "", "", ""
    for n in range(joints):
        if n % 6 == 0:
            bodies += f'<body pos="0 {n / 6} 2">'
        axis = "0 1 0" if n % 2 == 0 else "1 0 0"
        bodies += (
            f'<body pos="0 0 {-0.2 if n % 6 else 0}"><joint name="j{n}" axis="{axis}" damping="0.2"/>'
            '<geom type="capsule" fromto="0 0 0 0 0 -0.2" size="0.03" mass="0.6" contype="0" conaffinity="0"/>'
        )
        if n % 6 == 5:
            bodies += "</body>" * 7
        actuators += f'<plugin name="a{n}" joint="j{n}" plugin="{plugin}" instance="i{n}"/>'
        motors += f'<motor name="a{n}" joint="j{n}" gear="6"/>'
    world = f'<option timestep="0.001" integrator="implicitfast"/><worldbody>{bodies}</worldbody>'
    extension = f'<extension><plugin plugin="{plugin}">{instances}</plugin></extension>'
    return (
        f"<mujoco>{extension}{world}<actuator>{actuators}</actuator></mujoco>",
        f"<mujoco>{world}<actuator>{motors}</actuator></mujoco>",
    )


def many(text):
    """36 joints in a model: equal arms move equally, and the cost beside a model with plain motors."""
    costs = []
    for model in map(mujoco.MjModel.from_xml_string, chain(text, 36)):
        data = mujoco.MjData(model)
        for step in range(400):
            data.ctrl[:] = np.tile(0.5 * np.sin(0.02 * step + np.arange(6)), 6)
            mujoco.mj_step(model, data)
        assert np.isfinite(data.qpos).all()
        if not costs:
            spread = np.ptp(data.qpos.reshape(6, 6), axis=0).max()
        began = time.process_time()
        for _ in range(1000):
            mujoco.mj_step(model, data)
        costs.append(time.process_time() - began)
    print(f"many spread {spread:.3e} us_per_step {1e3 * costs[0]:.1f} {1e3 * costs[1]:.1f} ratio {costs[0] / costs[1]:.2f}")


def control_of(model, step):
    """Torque, or angle of the link with a controller, whose gap the motion crosses."""
    return (0.1 if model.nsensordata > LINK_TORQUE + 1 else 1.0) * np.sin(0.02 * step)


def drive(model, data, steps, first=0):
    for step in range(first, first + steps):
        data.ctrl[0] = control_of(model, step)
        mujoco.mj_step(model, data)
    return state_of(model, data)


def resume(text, path, law):
    """Continues in this process from a state that another process saved."""
    model = load(with_law(text, law) if law else text)
    data = mujoco.MjData(model)
    with open(path, "rb") as file:
        saved, expected = pickle.load(file)
    mujoco.mj_setState(model, data, saved, STATE)
    assert (drive(model, data, 700, 500) == expected).all(), "another process continued with other bits"
    print("resumed")


def save(text, folder, law=""):
    """Saved states continue with equal bits: in the same data, in other data, by threads, and in another process."""
    model = load(with_law(text, law) if law else text)
    data = mujoco.MjData(model)
    saved = drive(model, data, 500)
    expected = drive(model, data, 700, 500)
    for place in (data, mujoco.MjData(model)):
        mujoco.mj_setState(model, place, saved, STATE)
        # A look at forces without a step changes nothing.
        mujoco.mj_forward(model, place)
        mujoco.mj_forward(model, place)
        assert (drive(model, place, 700, 500) == expected).all(), "a restored state continued with other bits"
    other = mujoco.MjData(model)
    mujoco.mj_setState(model, other, saved, STATE)
    copied = copy.copy(other)
    for place in (other, copied):
        assert (drive(model, place, 700, 500) == expected).all(), "a copy continued with other bits"
    mujoco.mj_resetData(model, data)
    assert (drive(model, data, 500) == saved).all(), "a reset did not start anew"
    from mujoco import rollout

    controls = np.array([control_of(model, step) for step in range(500, 1200)])[None, :, None].repeat(8, axis=0)
    states, _ = rollout.rollout(model, [mujoco.MjData(model) for _ in range(2)], np.tile(saved, (8, 1)), controls)
    assert (states[:, -1] == expected).all(), "threads continued with other bits"
    path = os.path.join(folder, "state.pickle")
    with open(path, "wb") as file:
        pickle.dump((saved, expected), file)
    sys.stdout.flush()
    subprocess.run([sys.executable, __file__, "resume", *sys.argv[2:4], path, law], check=True)
    print("saved")


def refused(text):
    """Models that cannot be stepped right are refused with the reason."""
    plugin = re.search(r'plugin plugin="([^"]*)"', text).group(1)
    cases = {
        "RK4": load_error(text, integrator="RK4"),
        "timestep": load_error(text, timestep=0.00015),
        "hinge": load_error(text.replace('type="hinge"', 'type="slide"')),
        "gear": load_error(text.replace('joint="hinge" plugin', 'joint="hinge" gear="2" plugin')),
        "instance": load_error(
            text.replace("</actuator>", f'<plugin name="second" joint="hinge" plugin="{plugin}" instance="joint"/></actuator>')
        ),
    }
    limited = 'joint="hinge" forcelimited="true" forcerange="-1 1" plugin'
    cases["forcerange"] = load_error(text.replace('joint="hinge" plugin', limited))
    for word, message in cases.items():
        assert word in message, f"{word}: {message}"
    model = load(text)
    data = mujoco.MjData(model)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    try:
        mujoco.mj_step(model, data)
        raise AssertionError("a change of the integrator was not seen")
    except mujoco.FatalError as error:
        assert "RK4" in str(error), error
    print("refused")


def target_of(time, frequency):
    """Reversing target: angle, speed, acceleration."""
    pulse, amplitude = 2 * np.pi * frequency, 0.1
    sine, cosine = np.sin(pulse * time), np.cos(pulse * time)
    return amplitude * sine, amplitude * pulse * cosine, -amplitude * pulse**2 * sine


def errors_with_controller(text, frequency):
    """Errors of the link [rad], and numbers of the sensor, in every step of 8 s."""
    model = load(with_law(text))
    data = mujoco.MjData(model)
    errors, sensed = np.empty(8000), np.empty((8000, model.nsensordata))
    for step in range(len(errors)):
        data.ctrl[0] = target_of(1e-3 * step, frequency)[0]
        mujoco.mj_step(model, data)
        sensed[step] = data.sensordata
        errors[step] = data.sensordata[LINK_ANGLE] - target_of(1e-3 * step, frequency)[0]
    return errors, sensed


def errors_with_pid(text, frequency, ratio, inertia):
    """Errors of the link [rad] with a PID controller on the true motor angle, with the target's speed and acceleration."""
    model = load(text)
    data = mujoco.MjData(model)
    bandwidth, integral = 60.0, 0.0
    errors = np.empty(8000)
    for step in range(len(errors)):
        angle, speed, acceleration = target_of(1e-3 * step, frequency)
        mujoco.mj_forward(model, data)
        error = ratio * angle - data.sensordata[MOTOR_ANGLE]
        error_rate = ratio * speed - data.sensordata[MOTOR_SPEED]
        integral += 0.25 * bandwidth * error * 1e-3
        wanted = ratio * acceleration + bandwidth**2 * (error + integral) + 2 * bandwidth * error_rate
        data.ctrl[0] = inertia * wanted
        mujoco.mj_step(model, data)
        errors[step] = data.sensordata[LINK_ANGLE] - angle
    return errors


def controlled(text, ratio, inertia, half_backlash):
    """Errors with the controller and with a PID controller; the estimates beside the true values."""
    for frequency in (0.3, 1.0, 3.0):
        errors, sensed = errors_with_controller(text, frequency)
        plain = errors_with_pid(text, frequency, ratio, inertia)
        rms, plain_rms = (1e3 * np.sqrt(np.mean(found[4000:] ** 2)) for found in (errors, plain))
        widths = sensed[:, HALF_BACKLASH]
        off = np.abs(widths / half_backlash - 1.0) > 0.1
        gap = np.sqrt(np.mean((sensed[4000:, ESTIMATED_GAP] - sensed[4000:, GAP]) ** 2))
        print(
            f"controlled {frequency} rms_mrad {rms:.4f} peak_mrad {1e3 * np.abs(errors[4000:]).max():.4f} "
            f"pid_rms_mrad {plain_rms:.4f} pid_peak_mrad {1e3 * np.abs(plain[4000:]).max():.4f} gain {plain_rms / rms:.1f} "
            f"first_width {widths[1] / half_backlash:.4f} width {widths[-1] / half_backlash:.4f} "
            f"settled_after_s {1e-3 * (np.flatnonzero(off)[-1] + 1 if off.any() else 0):.3f} "
            f"width_valid {sensed[-1, HALF_BACKLASH_VALID]:.0f} gap_rms {gap / half_backlash:.4f} "
            f"gap_valid {sensed[4000:, GAP_VALID].mean():.3f} trust {sensed[4000:, TRUST].mean():.3f}"
        )


def laws(text):
    """Impedance, jumps, targets that are no number, angles that are set, wrong keys."""
    model = load(with_law(text, IMPEDANCE))
    data = mujoco.MjData(model)
    deflections = []
    for torque in (0.0, -3.0):
        data.qfrc_applied[0] = torque
        for _ in range(4000):
            data.ctrl[0] = 0.1
            mujoco.mj_step(model, data)
        deflections.append(data.sensordata[LINK_ANGLE])
    print(f"impedance deflection {deflections[0] - deflections[1]:.5f} expected {3.0 / 150.0:.5f}")

    model = load(with_law(text))
    data = mujoco.MjData(model)
    for target, expected in ((0.2, 0.2), (np.nan, 0.2), (-0.1, -0.1), (np.inf, -0.1)):
        for _ in range(2000):
            data.ctrl[0] = target
            mujoco.mj_step(model, data)
        assert abs(data.sensordata[LINK_ANGLE] - expected) < 2e-3, (target, data.sensordata)
    for angle in (1.0, -2.5, 700.0):
        mujoco.mj_resetData(model, data)
        for turned in (angle, angle + 0.5):
            data.qpos[0], data.qvel[0], data.ctrl[0] = turned, 0.0, turned
            for _ in range(2000):
                mujoco.mj_step(model, data)
            assert abs(data.qpos[0] - turned) < 2e-3, (turned, data.qpos, data.sensordata)
            assert abs(data.sensordata[ESTIMATED_LINK_ANGLE] - turned) < 4e-3, (turned, data.sensordata)
    wrong = load_error(with_law(text, '<config key="controller" value="positon"/>'))
    assert "none, position, impedance" in wrong, wrong
    wrong = load_error(with_law(text, '<config key="controller" value="impedance"/><config key="stiffness" value="-1"/>'))
    assert "stiffness" in wrong, wrong
    print("laws")


def pair(text, other_plugin, other_path):
    """Two joints of different files in a model, one with a controller, move as each does alone; a controller's cost."""
    mujoco.mj_loadPluginLibrary(os.path.abspath(other_plugin))
    with open(other_path) as file:
        other_text = file.read()
    parts = []
    for name, part in (("a", with_law(text)), ("b", with_law(other_text)), ("c", other_text)):
        inner = lambda tag: re.search(f"<{tag}>(.*?)</{tag}>", part, re.S).group(1)
        rename = lambda piece: re.sub(r'(name|joint|instance)="(joint|hinge|motor|link)"', rf'\1="\2_{name}"', piece)
        parts.append([rename(inner(tag)) for tag in ("extension", "worldbody", "actuator", "sensor")])
    plugins = [part[0] for part in parts]
    both = re.sub(r"\s*<plugin[^>]*>|</plugin>\s*$", "", plugins[2])
    plugins[1] = plugins[1].replace("</plugin>", both + "</plugin>")
    option = re.search(r"<option[^>]*>", text).group(0)
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco>{option}<extension>{plugins[0]}{plugins[1]}</extension>"
        + "".join(f"<{tag}>{''.join(part[at] for part in parts)}</{tag}>" for at, tag in ((1, "worldbody"), (2, "actuator"), (3, "sensor")))
        + "</mujoco>"
    )
    alone = [load(with_law(text)), load(with_law(other_text)), load(other_text)]
    datas, data = [mujoco.MjData(one) for one in alone], mujoco.MjData(model)
    for step in range(1500):
        controls = (0.1 * np.sin(0.01 * step), 0.05 * np.sin(0.02 * step), 0.2 * np.sin(0.03 * step))
        data.ctrl[:] = controls
        mujoco.mj_step(model, data)
        for one, own, control in zip(alone, datas, controls):
            own.ctrl[0] = control
            mujoco.mj_step(one, own)
    assert (data.sensordata == np.concatenate([own.sensordata for own in datas])).all(), "a joint moves otherwise beside others"
    costs = []
    for one, amplitude in ((load(text), 0.3), (load(with_law(text)), 0.1)):
        own = mujoco.MjData(one)
        began = time.process_time()
        for step in range(3000):
            own.ctrl[0] = amplitude * np.sin(0.01 * step)
            mujoco.mj_step(one, own)
        costs.append(time.process_time() - began)
    print(f"pair us_per_step {1e6 * costs[0] / 3000:.1f} {1e6 * costs[1] / 3000:.1f} ratio {costs[1] / costs[0]:.2f}")


def load_error(text, **changes):
    try:
        mujoco.MjData(load(text, **changes))
    except (ValueError, mujoco.FatalError) as error:
        return str(error)
    return "no error"


def set_angle(text):
    """An angle that is set from outside takes the whole joint along, without a shock."""
    model = load(text)
    data = mujoco.MjData(model)
    for angle in (1.0, -2.5, 700.0):
        mujoco.mj_resetData(model, data)
        data.qpos[0] = angle
        for _ in range(20):
            mujoco.mj_step(model, data)
        assert abs(data.sensordata[LINK_ANGLE] - data.qpos[0]) < 0.02, (angle, data.sensordata)
        drive(model, data, 300)
        data.qpos[0] += 0.5
        mujoco.mj_step(model, data)
        assert abs(data.actuator_force[0]) < 60.0, data.actuator_force
    print("set")


def limits(text):
    """A command beyond its range is the range's end; one that is no number is zero, and ends nothing."""
    text = re.sub(r'ctrlrange="[^"]*"', 'ctrlrange="-0.5 0.25"', text)
    for command, expected in ((100.0, 0.25), (-100.0, -0.5), (np.nan, 0.0), (np.inf, 0.0)):
        model = load(text)
        data = mujoco.MjData(model)
        for _ in range(20):
            data.ctrl[0] = command
            mujoco.mj_step(model, data)
        found = data.sensordata[MOTOR_TORQUE]
        assert abs(found - expected) < 0.05 * abs(expected) + 1e-6, (command, expected, found)
    print("limits")


if __name__ == "__main__":
    check, plugin, path, *rest = sys.argv[1:]
    mujoco.mj_loadPluginLibrary(os.path.abspath(plugin))
    with open(path) as file:
        model_text = file.read()
    checks = {"many": many, "refused": refused, "set": set_angle, "limits": limits, "laws": laws}
    if check == "accuracy":
        accuracy(model_text, rest[0])
    elif check == "energy":
        energy(model_text, *map(float, rest))
    elif check == "save":
        save(model_text, rest[0])
        for law in (POSITION, IMPEDANCE):
            save(model_text, rest[0], law)
    elif check == "resume":
        resume(model_text, *rest)
    elif check == "controlled":
        controlled(model_text, *map(float, rest))
    elif check == "pair":
        pair(model_text, *rest)
    else:
        checks[check](model_text)
