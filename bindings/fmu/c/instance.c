/* Life of an instance: stages, values, communication steps and saved states. */
#include "instance.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Mark of a living instance: ASCII "FMU1". */
#define MARK 0x464d5531u
/*
 * Largest deviation of a communication point from a whole control period [periods]. Derived: a master that adds a step of one
 * period n times rounds by n^2 / 2^53 periods at most; 0.1 is exceeded after 3e7 steps, 50 minutes at 10 kHz.
 */
#define TOLERANCE 0.1
/*
 * Largest distance of the start from time zero [periods]. Derived: a double there rounds by 1e14 / 2^53 = 0.011 periods, and
 * three such roundings of a communication point stay below TOLERANCE.
 */
#define MAX_START 1e14
/* Longest communication step [periods]: within the 32 bits in which controller.c counts the periods of a step. */
#define MAX_PERIODS 4e9

static const char *stage_name(unsigned stage) {
    switch (stage) {
        case INSTANTIATED: return "after instantiation";
        case INITIALIZING: return "in initialization mode";
        case STEPPING: return "between communication steps";
        default: return "after termination";
    }
}

Outcome instance_refuse(const Instance *instance, Outcome outcome, const char *format, ...) {
    char message[512];
    va_list arguments;
    if ((instance->logged & (outcome == DISCARDED ? LOG_DISCARD : LOG_ERROR)) != 0) {
        va_start(arguments, format);
        (void)vsnprintf(message, sizeof message, format, arguments);
        va_end(arguments);
        instance->report(instance, outcome, message);
    }
    return outcome;
}

Outcome instance_log(Instance *instance, int on, size_t count, const char *const *categories, const char *function) {
    unsigned logged = on && count == 0 ? LOG_ALL : 0;
    size_t index;
    if (instance_has_arrays(instance, categories, categories, count, function) != SUCCEEDED) {
        return FAILED;
    }
    for (index = 0; index < count; index++) {
        const char *const category = categories[index] == NULL ? "" : categories[index];
        if (strcmp(category, "logStatusError") == 0) {
            logged |= LOG_ERROR;
        } else if (strcmp(category, "logStatusDiscard") == 0) {
            logged |= LOG_DISCARD;
        } else {
            return instance_refuse(instance, FAILED, "%s: no category \"%.64s\": give logStatusError or logStatusDiscard",
                                   function, category);
        }
    }
    instance->logged = on ? logged : 0;
    return SUCCEEDED;
}

static void set_start_values(Model *model) {
    size_t index;
    memset(model, 0, sizeof *model);
    for (index = 0; index < VARIABLES; index++) {
        model->values[index] = variables[index].start;
    }
    model->stop_s = HUGE_VAL;
    model->stage = INSTANTIATED;
}

Instance *instance_new(const Instance *callbacks, const char *name, const char *token) {
    Instance *instance;
    if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
        (void)instance_refuse(callbacks, FAILED, "token \"%.64s\" given, but this binary has \"%s\": unpack the FMU again, so that "
                              "modelDescription.xml and binary belong together", token == NULL ? "" : token, MODEL_TOKEN);
        return NULL;
    }
    instance = calloc(1, sizeof *instance);
    if (instance != NULL) {
        const size_t bytes = strlen(name == NULL ? "" : name) + 1;
        *instance = *callbacks;
        instance->name = malloc(bytes);
        if (instance->name != NULL) {
            memcpy(instance->name, name == NULL ? "" : name, bytes);
            set_start_values(&instance->model);
            instance->mark = MARK;
            return instance;
        }
    }
    free(instance);
    (void)instance_refuse(callbacks, FAILED, "no memory for an instance of %u bytes: free other instances", (unsigned)sizeof *instance);
    return NULL;
}

void instance_free(void *pointer) {
    Instance *instance = instance_at(pointer);
    if (instance != NULL) {
        while (instance->states != NULL) {
            State *next = instance->states->next;
            free(instance->states);
            instance->states = next;
        }
        instance->mark = 0;
        free(instance->name);
        free(instance);
    }
}

Instance *instance_at(void *pointer) {
    Instance *instance = pointer;
    return instance != NULL && instance->mark == MARK ? instance : NULL;
}

Outcome instance_may(const Instance *instance, unsigned stages, const char *function) {
    if ((instance->model.stage & stages) == 0) {
        return instance_refuse(instance, FAILED, "%s called %s: call the functions in the order of the FMI standard; nothing was "
                               "changed", function, stage_name(instance->model.stage));
    }
    return SUCCEEDED;
}

Outcome instance_advance(Instance *instance, unsigned from, unsigned to, const char *function) {
    if (instance_may(instance, from, function) != SUCCEEDED) {
        return FAILED;
    }
    instance->model.stage = to;
    return SUCCEEDED;
}

static Outcome outcome_of(const Instance *instance, JointStatus status, const char *function) {
    return status == JOINT_STATUS_OK ? SUCCEEDED
                                     : instance_refuse(instance, FAILED, "%s: %s", function, joint_status_text(status));
}

Outcome instance_set_times(Instance *instance, double start_s, int has_stop, double stop_s, const char *function) {
    const double limit_s = MAX_START / CONTROL_RATE_HZ;
    if (instance_may(instance, INSTANTIATED, function) != SUCCEEDED) {
        return FAILED;
    }
    /* NaN fails every comparison. */
    if (!(start_s >= -limit_s && start_s <= limit_s)) {
        return instance_refuse(instance, FAILED, "%s: start time %g s: give a finite time from %g s to %g s, where doubles "
                               "resolve a control period", function, start_s, -limit_s, limit_s);
    }
    if (has_stop && !(stop_s >= start_s)) {
        return instance_refuse(instance, FAILED, "%s: stop time %g s, start time %g s: give a stop time that is not before the "
                               "start, or none", function, stop_s, start_s);
    }
    instance->model.start_s = start_s;
    instance->model.stop_s = has_stop ? stop_s : HUGE_VAL;
    return SUCCEEDED;
}

Outcome instance_initialize(Instance *instance, const char *function) {
    Model *const model = &instance->model;
    if (instance_may(instance, INSTANTIATED, function) != SUCCEEDED ||
        outcome_of(instance, model_start(model), function) != SUCCEEDED ||
        outcome_of(instance, model_outputs(model), function) != SUCCEEDED) {
        return FAILED;
    }
    model->values[VALUE_time] = model->start_s;
    model->stage = INITIALIZING;
    return SUCCEEDED;
}

Outcome instance_reset(Instance *instance) {
    set_start_values(&instance->model);
    return SUCCEEDED;
}

/* Control periods of a communication step. */
static Outcome count_periods(const Instance *instance, double from_s, double step_s, uint64_t *periods, const char *function) {
    const Model *const model = &instance->model;
    const double done = (double)model->periods, late = (from_s - model->start_s) * CONTROL_RATE_HZ - done;
    /* End of the step since the start, in periods: deviations of single steps do not add up. */
    const double end = (from_s + step_s - model->start_s) * CONTROL_RATE_HZ;
    /* NaN fails every comparison. */
    const double whole = end > done && end - done < MAX_PERIODS ? (double)(uint64_t)(end + 0.5) : 0.0;
    if (!(late > -0.5 && late < 0.5)) {
        return instance_refuse(instance, FAILED, "%s: the communication point is %.17g s, but this instance stands at %.17g s: "
                               "step from there, or restore a saved state", function, from_s, model->values[VALUE_time]);
    }
    if (!(whole - done >= 1.0 && end - whole <= TOLERANCE && whole - end <= TOLERANCE)) {
        return instance_refuse(instance, instance->refused, "%s: a communication step of %.17g s is %.9g control periods: use a "
                               "multiple of %.17g s; nothing was changed", function, step_s, step_s * CONTROL_RATE_HZ,
                               1.0 / CONTROL_RATE_HZ);
    }
    if ((model->stop_s - model->start_s) * CONTROL_RATE_HZ < whole - 0.5) {
        return instance_refuse(instance, instance->refused, "%s: the step ends at %.17g s, after the stop time %.17g s: step to "
                               "the stop time, or reset and give a later one; nothing was changed", function, from_s + step_s,
                               model->stop_s);
    }
    *periods = (uint64_t)(whole - done);
    return SUCCEEDED;
}

Outcome instance_step(Instance *instance, double from_s, double step_s, const char *function) {
    Model *const model = &instance->model;
    Model before;
    uint64_t left = 0;
    Outcome outcome = instance_may(instance, STEPPING, function);
    JointStatus status = JOINT_STATUS_OK;
    if (outcome == SUCCEEDED) {
        outcome = count_periods(instance, from_s, step_s, &left, function);
    }
    if (outcome != SUCCEEDED) {
        return outcome;
    }
    before = *model;
    model->step_began = model->periods;
    for (; left > 0 && status == JOINT_STATUS_OK; left--) {
        status = model_period(model);
        model->periods++;
    }
    if (status == JOINT_STATUS_OK) {
        status = model_outputs(model);
    }
    outcome = outcome_of(instance, status, function);
    if (outcome != SUCCEEDED) {
        *model = before;
        return outcome;
    }
    model->values[VALUE_time] = model->start_s + (double)model->periods / CONTROL_RATE_HZ;
    return SUCCEEDED;
}

Outcome instance_has_arrays(const Instance *instance, const void *references, const void *values, size_t count,
                            const char *function) {
    if (count > 0 && (references == NULL || values == NULL)) {
        return instance_refuse(instance, FAILED, "%s: an array of %lu elements is NULL: pass all arrays", function,
                               (unsigned long)count);
    }
    return SUCCEEDED;
}

static const char *const kinds[] = {"a real number", "an integer", "a truth value"};

static Outcome check_kind(const Instance *instance, Kind kind, uint32_t reference, const char *function) {
    if (reference >= VARIABLES) {
        return instance_refuse(instance, FAILED, "%s: no variable has value reference %u: take it from modelDescription.xml",
                               function, (unsigned)reference);
    }
    if (variables[reference].kind != kind) {
        return instance_refuse(instance, FAILED, "%s: %s is %s: call the function of its type", function,
                               variables[reference].name, kinds[variables[reference].kind]);
    }
    return SUCCEEDED;
}

Outcome instance_readable(const Instance *instance, Kind kind, const uint32_t *references, size_t count, const char *function) {
    size_t index;
    for (index = 0; index < count; index++) {
        if (check_kind(instance, kind, references[index], function) != SUCCEEDED) {
            return FAILED;
        }
    }
    return SUCCEEDED;
}

Outcome instance_settable(const Instance *instance, Kind kind, uint32_t reference, double value, const char *function) {
    const Variable *const variable = reference < VARIABLES ? &variables[reference] : NULL;
    if (check_kind(instance, kind, reference, function) != SUCCEEDED) {
        return FAILED;
    }
    if (!variable->is_input) {
        return instance_refuse(instance, FAILED, "%s: %s is no input: set inputs only", function, variable->name);
    }
    /* NaN fails both comparisons. */
    if (!(value >= variable->min && value <= variable->max)) {
        return instance_refuse(instance, instance->refused, "%s: %s is to be %g: give a number from %g to %g, in the unit %s; "
                               "nothing was set", function, variable->name, value, variable->min, variable->max,
                               variable->unit);
    }
    return SUCCEEDED;
}

/* Link to a saved state, in the list; its end if the pointer is no state of this instance. */
static State **find(Instance *instance, const void *state) {
    State **link = &instance->states;
    while (*link != NULL && *link != state) {
        link = &(*link)->next;
    }
    return link;
}

Outcome instance_save(Instance *instance, void **state, const char *function) {
    State *saved;
    if (state == NULL) {
        return instance_refuse(instance, FAILED, "%s: the pointer to the state is NULL: pass the address of a state", function);
    }
    if (*state != NULL) {
        saved = *find(instance, *state);
        if (saved == NULL) {
            return instance_refuse(instance, FAILED, "%s: not a state of this instance: give a pointer to NULL for a new "
                                   "one", function);
        }
    } else {
        saved = malloc(sizeof *saved);
        if (saved == NULL) {
            return instance_refuse(instance, FAILED, "%s: no memory for a state of %u bytes: free other states", function,
                                   (unsigned)sizeof *saved);
        }
        saved->next = instance->states;
        instance->states = saved;
        *state = saved;
    }
    memcpy(&saved->model, &instance->model, sizeof saved->model);
    return SUCCEEDED;
}

Outcome instance_restore(Instance *instance, void *state, const char *function) {
    const State *const saved = *find(instance, state);
    if (saved == NULL) {
        return instance_refuse(instance, FAILED, "%s: not a state of this instance, or a freed one: restore a state "
                               "that this instance saved", function);
    }
    memcpy(&instance->model, &saved->model, sizeof saved->model);
    return SUCCEEDED;
}

Outcome instance_forget(Instance *instance, void **state, const char *function) {
    State **link;
    State *freed;
    if (state == NULL || *state == NULL) {
        return SUCCEEDED;
    }
    link = find(instance, *state);
    freed = *link;
    if (freed == NULL) {
        return instance_refuse(instance, FAILED, "%s: not a state of this instance, or a freed one: free a state "
                               "once, with the instance that saved it", function);
    }
    *link = freed->next;
    free(freed);
    *state = NULL;
    return SUCCEEDED;
}
