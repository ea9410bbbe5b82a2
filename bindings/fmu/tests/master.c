/*
 * A master for the FMUs of a joint, plant and controller. Arguments: path and token of each. It calls in the wrong order,
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

/* Expects a refusal whose message has a word, told with its status and category. */
static void expect_answer(int found, int status, const char *word, const char *what) {
    expect(found, status, what);
    expect(told_status, status, what);
    expect(strcmp(told_category, status == REFUSED ? "logStatusError" : "logStatusDiscard"), 0, what);
    if (strstr(message, word) == NULL) {
        fail(what, found, word);
    }
    message[0] = 0;
}

static void expect_refused(int found, const char *word, const char *what) {
    expect_answer(found, REFUSED, word, what);
}

/* Expects that a step size or a value is refused, and that the instance lives on. */
static void expect_discarded(int found, const char *word, const char *what) {
    expect_answer(found, BAD_VALUE, word, what);
}

/* State to which an instance returns after an error. */
static void *kept;

/* Expects an error, which terminates an instance in FMI 3; restores the kept state. */
static void expect_error(const Unit *unit, void *instance, int found, const char *word, const char *what) {
    expect_refused(found, word, what);
    if (FMI == 3) {
        expect_refused(step(unit, instance, 0.0, PERIOD_S), "after termination", what);
        expect(unit->restore(instance, kept), DONE, "restore after an error");
    }
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
        expect(set_real(plant, instance, PLANT_external_torque, share * torque(period / 7)), DONE, "load");
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
    double read[1];
    expect(instantiate(plant, "{another}") == NULL, 1, "wrong token");
    expect(strstr(message, "unpack the FMU again") != NULL, 1, "message of the wrong token");
    expect(step(plant, NULL, 0.0, PERIOD_S), REFUSED, "step of NULL");
    expect(plant->terminate(NULL), REFUSED, "end of NULL");
    plant->free(NULL);
    instance = instantiate(plant, plant->token);
    expect(plant->save(instance, &kept), DONE, "keep");
    expect_error(plant, instance, step(plant, instance, 0.0, PERIOD_S), "after instantiation", "step before initialization");
    expect_error(plant, instance, plant->initialized(instance), "order", "end of an initialization that did not begin");
    expect_error(plant, instance, plant->terminate(instance), "order", "end before initialization");
    if (FMI == 3) {
        expect_error(plant, instance, initialize(plant, instance, NAN), "finite", "start at NaN");
    } else {
        expect(initialize(plant, instance, NAN), REFUSED, "start at NaN");
        expect(plant->reset(instance), DONE, "reset");
    }
    expect(initialize(plant, instance, 0.0), DONE, "initialize");
    expect(plant->save(instance, &kept), DONE, "keep");
    expect_error(plant, instance, initialize(plant, instance, 0.0), "initialization mode", "second initialization");
    expect_error(plant, instance, step(plant, instance, 0.0, PERIOD_S), "initialization mode", "step in initialization");
    expect(plant->initialized(instance), DONE, "initialized");
    expect(plant->save(instance, &kept), DONE, "keep");
    expect_discarded(set_real(plant, instance, PLANT_motor_torque, NAN), "motor_torque", "NaN");
    expect_discarded(set_real(plant, instance, PLANT_motor_torque, 1e300), "to 3.40282e+38, in the unit N.m", "more than 32 bits");
    expect_error(plant, instance, set_real(plant, instance, PLANT_gap, 0.0), "gap is no input", "output set");
    expect_error(plant, instance, set_real(plant, instance, PLANT_motor_counts, 0.0), "an integer", "integer set as real");
    expect_error(plant, instance, set_real(plant, instance, 4000000000u, 0.0), "modelDescription.xml", "unknown reference");
    expect_error(plant, instance, plant->set_real(instance, two, 2, values COUNT(2)), "gap", "the second of two refused");
    expect(value_of(plant, instance, PLANT_motor_torque, 'r') == 0.0, 1, "the first of two unchanged");
    expect_error(plant, instance, plant->set_real(instance, NULL, 1, values COUNT(1)), "NULL", "no references to set");
    expect_error(plant, instance, plant->set_real(instance, two, 1, NULL COUNT(1)), "NULL", "no values to set");
    expect_error(plant, instance, plant->get_real(instance, NULL, 1, read COUNT(1)), "NULL", "no references to read");
    expect_error(plant, instance, plant->get_real(instance, two, 1, NULL COUNT(1)), "NULL", "no room for values");
    expect(plant->set_real(instance, NULL, 0, NULL COUNT(0)), DONE, "nothing to set");
    expect_discarded(step(plant, instance, 0.0, 1.5 * PERIOD_S), "1.5 control periods", "step of one and a half");
    expect_discarded(step(plant, instance, 0.0, 0.0), "multiple", "step of zero");
    expect_discarded(step(plant, instance, 0.0, -PERIOD_S), "multiple", "step back");
    expect_discarded(step(plant, instance, 0.0, NAN), "multiple", "step of NaN");
    expect_discarded(step(plant, instance, 0.0, INFINITY), "multiple", "endless step");
    expect_error(plant, instance, step(plant, instance, 1.0, PERIOD_S), "stands at 0 s", "step from a later time");
    expect_error(plant, instance, step(plant, instance, NAN, PERIOD_S), "stands at 0 s", "step from NaN");
    expect(step(plant, instance, 0.0, PERIOD_S), DONE, "step after refusals");
    expect(plant->save(instance, &kept), DONE, "keep");
    expect_error(plant, instance, plant->restore(instance, NULL), "state", "no state");
    expect_error(plant, instance, plant->restore(instance, never), "state", "something else as a state");
    expect(plant->save(instance, &state), DONE, "save");
    other = started(plant);
    expect(plant->save(other, &foreign), DONE, "save");
    expect_error(plant, instance, plant->forget(instance, &foreign), "not a state of this instance", "another's state freed");
    expect_refused(plant->restore(other, state), "not a state of this instance", "state of another instance");
    plant->free(other);
    foreign = state;
    expect(plant->forget(instance, &state), DONE, "free");
    expect_error(plant, instance, plant->restore(instance, foreign), "freed", "freed state");
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

/* Refuses steps past the stop time by more than half a period. */
static void stop_times(const Unit *plant) {
    void *const instance = instantiate(plant, plant->token);
    const double wrong[] = {NAN, -PERIOD_S};
    int index;
    for (index = 0; index < 2; index++) {
        expect(initialize_until(plant, instance, 0.0, 1, wrong[index]), REFUSED, "wrong stop time");
        expect(strstr(message, "stop time") != NULL, 1, "message of a wrong stop time");
        expect(plant->reset(instance), DONE, "reset");
    }
    expect(initialize_until(plant, instance, 0.0, 1, 2.4 * PERIOD_S), DONE, "initialize until a stop time");
    expect(plant->initialized(instance), DONE, "initialized");
    expect_discarded(step(plant, instance, 0.0, 3.0 * PERIOD_S), "after the stop time", "step past the stop time");
    expect(value_of(plant, instance, PLANT_time, 'r') == 0.0, 1, "time after a refused step");
    expect(step(plant, instance, 0.0, 2.0 * PERIOD_S), DONE, "step to the stop time");
    expect_discarded(step(plant, instance, 2.0 * PERIOD_S, PERIOD_S), "after the stop time", "step beyond");
    expect(plant->reset(instance), DONE, "reset");
    expect(initialize_until(plant, instance, 0.0, 1, 2.6 * PERIOD_S), DONE, "initialize until another stop time");
    expect(plant->initialized(instance), DONE, "initialized");
    expect(step(plant, instance, 0.0, 3.0 * PERIOD_S), DONE, "step past the stop time by less than half a period");
    expect(plant->reset(instance), DONE, "reset");
    expect(initialize(plant, instance, 0.0), DONE, "initialize without a stop time");
    expect(plant->initialized(instance), DONE, "initialized");
    expect(step(plant, instance, 0.0, 9.0 * PERIOD_S), DONE, "step without a stop time");
    plant->free(instance);
}

/* Calls the logger for logged categories only. */
static void logging(const Unit *plant) {
    const char *const errors[] = {"logStatusError"}, *const unknown[] = {"logAll"};
    void *instance;
    message[0] = 0;
    expect(instantiate_with(plant, "{another}", 0) == NULL && message[0] != 0, 1, "failed instantiation explained");
    message[0] = 0;
    instance = instantiate_with(plant, plant->token, 0);
    expect(initialize(plant, instance, 0.0), DONE, "initialize");
    expect(plant->initialized(instance), DONE, "initialized");
    expect(step(plant, instance, 0.0, 1.5 * PERIOD_S), BAD_VALUE, "step of one and a half");
    expect(message[0], 0, "message with logging off");
    expect(plant->log(instance, 1, 1, errors), DONE, "log errors");
    expect(step(plant, instance, 0.0, 1.5 * PERIOD_S), BAD_VALUE, "step of one and a half");
    expect(message[0] != 0, FMI == 2, "message of a discarded step while errors are logged");
    expect(plant->log(instance, 1, 0, NULL), DONE, "log all");
    expect_discarded(step(plant, instance, 0.0, 1.5 * PERIOD_S), "1.5 control periods", "step of one and a half");
    expect_refused(plant->log(instance, 1, 1, unknown), "logAll", "unknown category");
    expect(plant->log(instance, 0, 0, NULL), DONE, "log nothing");
    expect(plant->terminate(instance) == DONE, FMI == 2, "terminate");
    expect(step(plant, instance, 0.0, PERIOD_S), REFUSED, "step after the end");
    expect(message[0], 0, "message with logging off again");
    plant->free(instance);
}

#if FMI == 2
/* Steps are over when fmi2DoStep returns: FMI 2 demands fmi2Discard for status that there is not. */
static void statuses(const Unit *plant) {
    void *const instance = started(plant);
    int (*get)(void *, int, void *);
    static const char *const names[] = {"fmi2GetStatus", "fmi2GetIntegerStatus", "fmi2GetStringStatus", "fmi2GetRealStatus",
                                        "fmi2GetBooleanStatus"};
    double value;
    size_t index;
    for (index = 0; index < sizeof names / sizeof names[0]; index++) {
        fetch(plant->library, names[index], &get);
        expect_answer(get(instance, fmi2DoStepStatus, &value), DISCARD, names[index], names[index]);
    }
    plant->free(instance);
}
#endif

/* Communication points of long simulations and of distant starts. */
static void communication_points(const Unit *controller) {
    void *instance = started(controller);
    const double start = 1e9;
    double time = 0.0;
    int period, status = DONE;
    /* The sum of a million steps is off by up to 1e-4 control periods. */
    for (period = 0; period < 1000000 && status == DONE; period++, time += PERIOD_S) {
        status = step(controller, instance, time, PERIOD_S);
    }
    expect(status, DONE, "a step of a million");
    expect(fabs(value_of(controller, instance, CONTROLLER_time, 'r') - 1e6 * PERIOD_S) < 1e-9, 1, "time after a million steps");
    /* Deviations do not add up. */
    expect(controller->reset(instance), DONE, "reset");
    expect(initialize(controller, instance, 0.0) == DONE && controller->initialized(instance) == DONE, 1, "initialize");
    for (period = 0, time = 0.0; period < 20 && status == DONE; period++, time += 1.01 * PERIOD_S) {
        status = step(controller, instance, time, 1.01 * PERIOD_S);
    }
    expect_discarded(status, "multiple", "steps of 1.01 periods");
    expect(period > 8 && period < 13, 1, "number of steps of 1.01 periods");
    /* Doubles resolve 0.1 us at 1e9 s. */
    expect(controller->reset(instance), DONE, "reset");
    expect(initialize(controller, instance, start) == DONE && controller->initialized(instance) == DONE, 1, "initialize");
    for (period = 0, status = DONE; period < 1000 && status == DONE; period++) {
        const double from = start + (double)period * PERIOD_S, to = start + (double)(period + 1) * PERIOD_S;
        status = step(controller, instance, from, to - from);
    }
    expect(status, DONE, "a step far from time zero");
    expect(controller->reset(instance), DONE, "reset");
    expect(initialize(controller, instance, 1.1e14 * PERIOD_S), REFUSED, "start that doubles do not resolve");
    controller->free(instance);
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
        digest = chain(chain(digest, command), value_of(controller, control, CONTROLLER_estimated_gap, 'r'));
        digest = chain(digest, value_of(plant, joint, PLANT_link_angle, 'r'));
    }
    expect_discarded(set_integer(controller, control, CONTROLLER_motor_counts, -1), "from 0 to", "negative counts");
    expect_discarded(set_real(controller, control, CONTROLLER_target_angle, 1e30),
                     "target_angle is to be 1e+30: give a number from -1.3493e+10 to 1.3493e+10", "far set-point");
    expect_discarded(set_real(controller, control, CONTROLLER_ahead_angle, -1.4e10), "ahead_angle", "far set-point ahead");
    expect(set_real(controller, control, CONTROLLER_target_angle, 1.349e10), DONE, "set-point within the limit");
    expect(set_boolean(controller, control, CONTROLLER_impedance, 0), DONE, "mode");
    expect(step(controller, control, (double)periods * PERIOD_S, PERIOD_S), DONE, "step to a set-point within the limit");
    plant->free(joint);
    controller->free(control);
    return digest;
}

/* Every tenth step of three periods, the others of one; readings of some age, motion ahead and a torque at the link. */
static uint64_t uneven_loop(const Unit *plant, const Unit *controller, int periods) {
    void *const joint = started(plant), *const control = started(controller);
    uint64_t digest = START;
    int period, many;
    for (period = 0; period < periods; period += many) {
        const double from = (double)period * PERIOD_S;
        const double angle = 0.3 * (double)(period % 1000 < 500 ? period % 1000 : 1000 - period % 1000) / 500.0;
        double command;
        many = period % 12 == 9 ? 3 : 1;
        expect(set_integer(controller, control, CONTROLLER_motor_counts, (int)value_of(plant, joint, PLANT_motor_counts, 'i')),
               DONE, "motor counts");
        expect(set_integer(controller, control, CONTROLLER_output_counts, (int)value_of(plant, joint, PLANT_output_counts, 'i')),
               DONE, "output counts");
        expect(set_integer(controller, control, CONTROLLER_motor_age, period % 300), DONE, "motor age");
        expect(set_integer(controller, control, CONTROLLER_output_age, period % 200 * 2), DONE, "output age");
        expect(set_boolean(controller, control, CONTROLLER_impedance, period / 3000 % 2), DONE, "mode");
        expect(set_boolean(controller, control, CONTROLLER_ahead_valid, period / 1500 % 2), DONE, "ahead valid");
        expect(set_real(controller, control, CONTROLLER_target_angle, angle), DONE, "angle");
        expect(set_real(controller, control, CONTROLLER_target_speed, 0.25), DONE, "speed");
        expect(set_real(controller, control, CONTROLLER_target_acceleration, 1.0), DONE, "acceleration");
        expect(set_real(controller, control, CONTROLLER_ahead_angle, angle + 0.01), DONE, "angle ahead");
        expect(set_real(controller, control, CONTROLLER_ahead_speed, 0.5), DONE, "speed ahead");
        expect(set_real(controller, control, CONTROLLER_ahead_acceleration, 2.0), DONE, "acceleration ahead");
        expect(set_real(controller, control, CONTROLLER_stiffness, 100.0), DONE, "stiffness");
        expect(set_real(controller, control, CONTROLLER_damping, 3.0), DONE, "damping");
        expect(set_real(controller, control, CONTROLLER_link_torque, 0.5), DONE, "torque at the link");
        expect(step(controller, control, from, (double)many * PERIOD_S), DONE, "step of the controller");
        command = value_of(controller, control, CONTROLLER_motor_torque, 'r');
        expect(set_real(plant, joint, PLANT_motor_torque, command), DONE, "torque");
        expect(set_real(plant, joint, PLANT_external_torque, 0.1 * torque(period / 7)), DONE, "external torque");
        expect(step(plant, joint, from, (double)many * PERIOD_S), DONE, "step of the plant");
        digest = chain(chain(digest, command), value_of(controller, control, CONTROLLER_estimated_gap, 'r'));
        digest = chain(digest, value_of(plant, joint, PLANT_link_angle, 'r'));
    }
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
    stop_times(&plant);
    logging(&plant);
#if FMI == 2
    statuses(&plant);
#endif
    communication_points(&controller);
    save_and_repeat(&plant);
    many_instances(&plant);
    instance = started(&plant);
    printf("single %016llx\n", (unsigned long long)run(&plant, instance, 0, 2000, 1, 1.0));
    plant.free(instance);
    instance = started(&plant);
    printf("tens %016llx\n", (unsigned long long)run(&plant, instance, 0, 2000, 10, 1.0));
    plant.free(instance);
    printf("loop %016llx\n", (unsigned long long)closed_loop(&plant, &controller, 6000));
    printf("uneven %016llx\n", (unsigned long long)uneven_loop(&plant, &controller, 6000));
    printf("%d failures\n", failures);
    return failures > 0;
}
