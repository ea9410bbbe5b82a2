"""FMPy imports the FMUs of a joint: arguments are the version, the plant's and the controller's file. Prints the digest of
the plant's run of master.c, which the test compares with the core's."""
import shutil
import struct
import sys

import numpy
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

MASK = (1 << 64) - 1


def chain(running, number):
    """Adds a number to a running digest, as model-core/src/numbers/digest.rs does."""
    bits = struct.unpack("<Q", struct.pack("<d", number))[0]
    return (((running << 5 | running >> 59) & MASK) ^ bits) * 0x9E3779B97F4A7C15 & MASK


class Unit:
    """An unpacked FMU, and its instances."""

    def __init__(self, version, path):
        self.version, self.description, self.folder = version, read_model_description(path), extract(path)
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.outputs = [variable for variable in self.description.modelVariables if variable.causality == "output"]
        self.period = float(self.description.defaultExperiment.stepSize)

    def start(self):
        kind = FMU2Slave if self.version == "2" else FMU3Slave
        identifier = self.description.coSimulation.modelIdentifier
        instance = kind(guid=self.description.guid, unzipDirectory=self.folder, modelIdentifier=identifier, instanceName="joint")
        instance.instantiate()
        if self.version == "2":
            instance.setupExperiment(startTime=0.0)
            instance.enterInitializationMode()
        else:
            instance.enterInitializationMode(startTime=0.0)
        instance.exitInitializationMode()
        return instance

    def set(self, instance, name, value):
        reference = [self.variables[name].valueReference]
        (instance.setReal if self.version == "2" else instance.setFloat64)(reference, [value])

    def values(self, instance):
        getters = {
            "Real": "getReal", "Integer": "getInteger", "Boolean": "getBoolean",
            "Float64": "getFloat64", "Int32": "getInt32",
        }
        return [float(getattr(instance, getters[one.type])([one.valueReference])[0]) for one in self.outputs]

    def step(self, instance, period, many=1):
        instance.doStep(currentCommunicationPoint=period * self.period, communicationStepSize=many * self.period)

    def run(self, instance, begin, end):
        digest = 0x6A6F696E742D3031
        for period in range(begin, end):
            self.set(instance, "motor_torque", (period * 37 % 101 - 50) * 0.02)
            self.set(instance, "external_torque", (period // 7 * 37 % 101 - 50) * 0.02)
            self.step(instance, period)
            for value in self.values(instance):
                digest = chain(digest, value)
        return digest


def end(instance):
    instance.terminate()
    instance.freeInstance()


def main(version, plant_file, controller_file):
    for file in plant_file, controller_file:
        problems = validate_fmu(file)
        assert not problems, problems
    unit = Unit(version, plant_file)

    # As users call it: torque in, motion out, three control periods a step.
    times = numpy.arange(200) * 3 * unit.period
    torque = numpy.array(list(zip(times, numpy.full(200, 0.5))), dtype=[("time", float), ("motor_torque", float)])
    result = simulate_fmu(plant_file, stop_time=0.06, step_size=3 * unit.period, output_interval=3 * unit.period, input=torque)
    assert result["link_angle"][-1] > 0.0 and numpy.isfinite(result["gap"]).all(), result[-1]
    simulate_fmu(controller_file, stop_time=10 * unit.period, step_size=unit.period, output_interval=unit.period)

    instance = unit.start()
    print(f"single {unit.run(instance, 0, 2000):016x}")
    save, restore, free = (getattr(instance, verb + ("FMUstate" if version == "2" else "FMUState")) for verb in ("get", "set", "free"))
    state = save()
    first = unit.run(instance, 2000, 2300)
    for _ in range(3):
        restore(state)
        assert unit.run(instance, 2000, 2300) == first, "a repeated run"
    free(state)
    try:
        unit.step(instance, 2300, 1.5)
    except Exception as refused:
        print(f"refused {refused}")
    else:
        raise AssertionError("one and a half periods were accepted")
    end(instance)

    instances = [unit.start() for _ in range(1000)]
    for index, one in enumerate(instances):
        unit.set(one, "motor_torque", 0.001 * index)
        unit.step(one, 0)
        unit.step(one, 1, 20)
    gaps = {unit.values(one)[0] for one in instances}
    assert len(gaps) > 900, f"{len(gaps)} different motions"
    for one in instances:
        end(one)
    shutil.rmtree(unit.folder)
    print("1000 instances")


main(*sys.argv[1:])
