/*
 * A master for the units of a joint, plant and controller. Arguments: path and token of each. It calls in the wrong order,
 * saves and restores, runs 1,000 instances and a closed loop; it prints digests that the test compares with the core's.
 */
#include "master.h"

#include <math.h>

/* Value references, types and control rate: written by the test. */
#include "references.h"

#define START 0x6a6f696e742d3031ull
#define PERIOD_S (1.0 / RATE_HZ)

static int failures;

/* Prints the first failures only: one wrong answer can repeat in every instance. */
static void fail(const char *what, int found, const char *expected) {
    if (failures++ < 20) {
        printf("%s: %d in place of %s: %s\n", what, found, expected, message);
    }
}

static void expect(int found, int expected, const char *what) {
    char text[16];
    if (found != expected) {
        (void)snprintf(text, sizeof text, "%d", expected);
        fail(what, found, text);
    }
}

/* Expects a refusal whose message has a word. */
static void expect_refused(int found, const char *word, const char *what) {
    expect(found, REFUSED, what);
    if (strstr(message, word) == NULL) {
        fail(what, found, word);
    }
    message[0] = 0;
}

static double torque(int period) {
    return (double)(period * 37 % 101 - 50) * 0.02;
}

static uint64_t add_outputs(uint64_t digest, const Unit *plant, void *instance) {
    size_t index;
    for (index = 0; index < sizeof plant_outputs / sizeof plant_outputs[0]; index++) {
        digest = chain(digest, value_of(plant, instance, plant_outputs[index], plant_kinds[index]));
    }
    return digest;
}

/* Steps a plant under the torques of some periods, `many` periods a step. */
static uint64_t run(const Unit *plant, void *instance, int from, int to, int many, double share) {
    uint64_t digest = START;
    int period;
    for (period = from; period < to; period += many) {
        expect(set_real(plant, instance, PLANT_motor_torque, share * torque(period)), DONE, "torque");
        expect(set_real(plant, instance, PLANT_load_torque, share * torque(period / 7)), DONE, "load");
        expect(step(plant, instance, (double)period * PERIOD_S, (double)many * PERIOD_S), DONE, "step");
        digest = add_outputs(digest, plant, instance);
    }
    return digest;
}

static void *started(const Unit *unit) {
    void *const instance = instantiate(unit, unit->token);
    if (instance == NULL) {
        printf("no instance: %s\n", message);
        exit(1);
    }
    expect(initialize(unit, instance, 0.0), DONE, "initialize");
    expect(unit->initialized(instance), DONE, "initialized");
    return instance;
}

static void wrong_order(const Unit *plant) {
    void *instance, *state = NULL, *other, *foreign = NULL, *never = &instance;
    const uint32_t two[] = {PLANT_motor_torque, PLANT_gap};
    const double values[] = {0.25, 0.5};
    expect(instantiate(plant, "{another}") == NULL, 1, "wrong token");
    expect(strstr(message, "unpack the FMU again") != NULL, 1, "message of the wrong token");
    expect(step(plant, NULL, 0.0, PERIOD_S), REFUSED, "step of NULL");
    expect(plant->terminate(NULL), REFUSED, "end of NULL");
    plant->free(NULL);
    instance = instantiate(plant, plant->token);
    expect_refused(step(plant, instance, 0.0, PERIOD_S), "after instantiation", "step before initialization");
    expect_refused(plant->initialized(instance), "order", "end of an initialization that did not begin");
    expect_refused(plant->terminate(instance), "order", "end before initialization");
    expect_refused(initialize(plant, instance, NAN), "finite", "start at NaN");
    expect(initialize(plant, instance, 0.0) == REFUSED, FMI == 2, "start without a start time");
    expect(plant->reset(instance), DONE, "reset");
    expect(initialize(plant, instance, 0.0), DONE, "initialize");
    expect_refused(initialize(plant, instance, 0.0), "initialization mode", "second initialization");
    expect_refused(step(plant, instance, 0.0, PERIOD_S), "initialization mode", "step in initialization");
    expect(plant->initialized(instance), DONE, "initialized");
    expect_refused(set_real(plant, instance, PLANT_motor_torque, NAN), "motor_torque", "NaN");
    expect_refused(set_real(plant, instance, PLANT_motor_torque, 1e300), "finite", "more than 32 bits");
    expect_refused(set_real(plant, instance, PLANT_gap, 0.0), "gap is no input", "output set");
    expect_refused(set_real(plant, instance, PLANT_motor_counts, 0.0), "an integer", "integer set as real");
    expect_refused(set_real(plant, instance, 4000000000u, 0.0), "modelDescription.xml", "unknown reference");
    expect_refused(plant->set_real(instance, two, 2, values COUNT(2)), "gap", "the second of two refused");
    expect(value_of(plant, instance, PLANT_motor_torque, 'r') == 0.0, 1, "the first of two unchanged");
    expect_refused(step(plant, instance, 0.0, 1.5 * PERIOD_S), "1.5 control periods", "step of one and a half");
    expect_refused(step(plant, instance, 0.0, 0.0), "multiple", "step of zero");
    expect_refused(step(plant, instance, 0.0, -PERIOD_S), "multiple", "step back");
    expect_refused(step(plant, instance, 0.0, NAN), "multiple", "step of NaN");
    expect_refused(step(plant, instance, 0.0, INFINITY), "multiple", "endless step");
    expect_refused(step(plant, instance, 1.0, PERIOD_S), "stands at 0 s", "step from a later time");
    expect_refused(step(plant, instance, NAN, PERIOD_S), "stands at 0 s", "step from NaN");
    expect(step(plant, instance, 0.0, PERIOD_S), DONE, "step after refusals");
    expect_refused(plant->restore(instance, NULL), "state", "no state");
    expect_refused(plant->restore(instance, never), "state", "something else as a state");
    expect(plant->save(instance, &state), DONE, "save");
    other = started(plant);
    expect_refused(plant->restore(other, state), "not a state of this instance", "state of another instance");
    expect(plant->save(other, &foreign), DONE, "save");
    expect_refused(plant->forget(instance, &foreign), "not a state of this instance", "another's state freed");
    plant->free(other);
    foreign = state;
    expect(plant->forget(instance, &state), DONE, "free");
    expect_refused(plant->restore(instance, foreign), "freed", "freed state");
    expect(plant->terminate(instance), DONE, "terminate");
    expect_refused(step(plant, instance, PERIOD_S, PERIOD_S), "after termination", "step after the end");
    expect_refused(plant->terminate(instance), "after termination", "second end");
    expect_refused(set_real(plant, instance, PLANT_motor_torque, 0.0), "after termination", "input after the end");
    expect(plant->reset(instance), DONE, "reset");
    expect(initialize(plant, instance, 5.0), DONE, "initialize again");
    expect(plant->initialized(instance), DONE, "initialized again");
    expect(step(plant, instance, 5.0, PERIOD_S), DONE, "step again");
    plant->free(instance);
}

static void save_and_repeat(const Unit *plant) {
    void *const instance = started(plant);
    void *state = NULL;
    uint64_t first;
    (void)run(plant, instance, 0, 500, 1, 1.0);
    expect(plant->save(instance, &state), DONE, "save");
    first = run(plant, instance, 500, 1500, 1, 1.0);
    for (int again = 0; again < 3; again++) {
        expect(plant->restore(instance, state), DONE, "restore");
        expect(run(plant, instance, 500, 1500, 1, 1.0) == first, 1, "repeated run");
    }
    expect(plant->save(instance, &state), DONE, "save over a saved state");
    expect(plant->forget(instance, &state), DONE, "free the state");
    plant->free(instance);
}

enum { INSTANCES = 1000 };

static void many_instances(const Unit *plant) {
    static void *all[INSTANCES];
    static uint64_t digests[INSTANCES];
    int index, period, different = 0;
    for (index = 0; index < INSTANCES; index++) {
        all[index] = started(plant);
    }
    for (period = 0; period < 40; period++) {
        for (index = 0; index < INSTANCES; index++) {
            digests[index] = run(plant, all[index], period, period + 1, 1, 0.001 * (double)index);
        }
    }
    for (index = 0; index < INSTANCES; index++) {
        plant->free(all[index]);
    }
    for (index = 0; index < INSTANCES; index += 111) {
        void *const alone = started(plant);
        uint64_t digest = 0;
        for (period = 0; period < 40; period++) {
            digest = run(plant, alone, period, period + 1, 1, 0.001 * (double)index);
        }
        expect(digest == digests[index], 1, "an instance among a thousand");
        different += index > 0 && digest != digests[0];
        plant->free(alone);
    }
    expect(different > 5, 1, "instances differ");
}

/* Controller, then plant, in every control period. */
static uint64_t closed_loop(const Unit *plant, const Unit *controller, int periods) {
    void *const joint = started(plant), *const control = started(controller);
    uint64_t digest = START;
    int period;
    for (period = 0; period < periods; period++) {
        const double from = (double)period * PERIOD_S;
        const double angle = 0.3 * (double)(period % 1000 < 500 ? period % 1000 : 1000 - period % 1000) / 500.0;
        double command;
        expect(set_integer(controller, control, CONTROLLER_motor_counts, (int)value_of(plant, joint, PLANT_motor_counts, 'i')),
               DONE, "motor counts");
        expect(set_integer(controller, control, CONTROLLER_output_counts, (int)value_of(plant, joint, PLANT_output_counts, 'i')),
               DONE, "output counts");
        expect(set_boolean(controller, control, CONTROLLER_output_valid, period % 1000 < 900), DONE, "output valid");
        expect(set_boolean(controller, control, CONTROLLER_impedance, period / 2000 % 2), DONE, "mode");
        expect(set_real(controller, control, CONTROLLER_target_angle, angle), DONE, "angle");
        expect(set_real(controller, control, CONTROLLER_stiffness, 100.0), DONE, "stiffness");
        expect(set_real(controller, control, CONTROLLER_damping, 3.0), DONE, "damping");
        expect(step(controller, control, from, PERIOD_S), DONE, "step of the controller");
        command = value_of(controller, control, CONTROLLER_motor_torque, 'r');
        expect(set_real(plant, joint, PLANT_motor_torque, command), DONE, "torque");
        expect(step(plant, joint, from, PERIOD_S), DONE, "step of the plant");
        digest = chain(chain(digest, command), value_of(controller, control, CONTROLLER_gap, 'r'));
        digest = chain(digest, value_of(plant, joint, PLANT_link_angle, 'r'));
    }
    expect_refused(set_integer(controller, control, CONTROLLER_motor_counts, -1), "from 0 on", "negative counts");
    expect(set_real(controller, control, CONTROLLER_target_angle, 1e30), DONE, "far angle");
    expect(set_boolean(controller, control, CONTROLLER_impedance, 0), DONE, "mode");
    expect_refused(step(controller, control, (double)periods * PERIOD_S, PERIOD_S), "turn", "target out of range");
    plant->free(joint);
    controller->free(control);
    return digest;
}

int main(int count, char **arguments) {
    Unit plant, controller;
    void *instance;
    if (count != 5) {
        return 2;
    }
    plant = load(arguments[1], arguments[2]);
    controller = load(arguments[3], arguments[4]);
    wrong_order(&plant);
    save_and_repeat(&plant);
    many_instances(&plant);
    instance = started(&plant);
    printf("single %016llx\n", (unsigned long long)run(&plant, instance, 0, 2000, 1, 1.0));
    plant.free(instance);
    instance = started(&plant);
    printf("tens %016llx\n", (unsigned long long)run(&plant, instance, 0, 2000, 10, 1.0));
    plant.free(instance);
    printf("loop %016llx\n", (unsigned long long)closed_loop(&plant, &controller, 6000));
    printf("%d failures\n", failures);
    return failures > 0;
}
