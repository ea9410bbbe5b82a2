/* Life of an instance: stages, values, communication steps and saved states. */
#include "instance.h"

#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Mark of a living instance: ASCII "FMU1". */
#define MARK 0x464d5531u
/* Largest deviation of a communication step from whole control periods, relative to the step. */
#define STEP_TOLERANCE 1e-6
/* Longest communication step in control periods: what a count in 32 bits holds. */
#define MOST_PERIODS 4e9

static const char *stage_name(unsigned stage) {
    switch (stage) {
        case INSTANTIATED: return "after instantiation";
        case INITIALIZING: return "in initialization mode";
        case STEPPING: return "between communication steps";
        default: return "after termination";
    }
}

int instance_refuse(const Instance *instance, const char *format, ...) {
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    instance->report(instance, message);
    return 0;
}

static void set_start_values(Model *model) {
    size_t index;
    memset(model, 0, sizeof *model);
    for (index = 0; index < VARIABLES; index++) {
        model->values[index] = variables[index].start;
    }
    model->stage = INSTANTIATED;
}

Instance *instance_new(const Instance *callbacks, const char *name, const char *token) {
    Instance *instance;
    if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
        (void)instance_refuse(callbacks, "token \"%.64s\" given, but this binary has \"%s\": unpack the FMU again, so that "
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
    (void)instance_refuse(callbacks, "no memory for an instance of %u bytes: free other instances", (unsigned)sizeof *instance);
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

int instance_may(const Instance *instance, unsigned stages, const char *function) {
    if ((instance->model.stage & stages) == 0) {
        return instance_refuse(instance, "%s called %s: call the functions in the order of the FMI standard; nothing was "
                               "changed", function, stage_name(instance->model.stage));
    }
    return 1;
}

static int succeeded(const Instance *instance, JointStatus status, const char *function) {
    return status == JOINT_STATUS_OK || instance_refuse(instance, "%s: %s", function, joint_status_text(status));
}

int instance_initialize(Instance *instance, const char *function) {
    Model *const model = &instance->model;
    if (!instance_may(instance, INSTANTIATED, function) ||
        !succeeded(instance, model_start(model), function) || !succeeded(instance, model_outputs(model), function)) {
        return 0;
    }
    model->values[VALUE_time] = model->start_s;
    model->stage = INITIALIZING;
    return 1;
}

int instance_reset(Instance *instance) {
    set_start_values(&instance->model);
    return 1;
}

/* Control periods of a communication step, or zero. */
static uint64_t periods_of(const Instance *instance, double from_s, double step_s, const char *function) {
    const double periods = step_s * CONTROL_RATE_HZ, now_s = instance->model.values[VALUE_time];
    const double late = (from_s - now_s) * CONTROL_RATE_HZ;
    uint64_t whole;
    double deviation;
    if (!(late > -0.5 && late < 0.5)) {
        return (uint64_t)instance_refuse(instance, "%s: the communication point is %.17g s, but this instance stands at %.17g s: "
                                         "step from there, or restore a saved state", function, from_s, now_s);
    }
    whole = periods >= 0.5 && periods < MOST_PERIODS ? (uint64_t)(periods + 0.5) : 0;
    deviation = periods - (double)whole;
    if (whole == 0 || deviation > STEP_TOLERANCE * periods || -deviation > STEP_TOLERANCE * periods) {
        return (uint64_t)instance_refuse(instance, "%s: a communication step of %.17g s is %.9g control periods: use a multiple of "
                                         "%.17g s; nothing was changed", function, step_s, periods, 1.0 / CONTROL_RATE_HZ);
    }
    return whole;
}

int instance_step(Instance *instance, double from_s, double step_s, const char *function) {
    Model *const model = &instance->model;
    Model before;
    uint64_t left;
    JointStatus status = JOINT_STATUS_OK;
    if (!instance_may(instance, STEPPING, function)) {
        return 0;
    }
    left = periods_of(instance, from_s, step_s, function);
    if (left == 0) {
        return 0;
    }
    before = *model;
    for (; left > 0 && status == JOINT_STATUS_OK; left--) {
        status = model_period(model);
        model->periods++;
    }
    if (status == JOINT_STATUS_OK) {
        status = model_outputs(model);
    }
    if (!succeeded(instance, status, function)) {
        *model = before;
        return 0;
    }
    model->values[VALUE_time] = model->start_s + (double)model->periods / CONTROL_RATE_HZ;
    return 1;
}

static const char *const kinds[] = {"a real number", "an integer", "a truth value"};

static int is_of_kind(const Instance *instance, Kind kind, uint32_t reference, const char *function) {
    if (reference >= VARIABLES) {
        return instance_refuse(instance, "%s: no variable has value reference %u: take it from modelDescription.xml", function,
                               (unsigned)reference);
    }
    if (variables[reference].kind != kind) {
        return instance_refuse(instance, "%s: %s is %s: call the function of its type", function, variables[reference].name,
                               kinds[variables[reference].kind]);
    }
    return 1;
}

int instance_readable(const Instance *instance, Kind kind, const uint32_t *references, size_t count, const char *function) {
    size_t index;
    for (index = 0; index < count; index++) {
        if (!is_of_kind(instance, kind, references[index], function)) {
            return 0;
        }
    }
    return 1;
}

int instance_settable(const Instance *instance, Kind kind, uint32_t reference, double value, const char *function) {
    const Variable *const variable = reference < VARIABLES ? &variables[reference] : NULL;
    if (!is_of_kind(instance, kind, reference, function)) {
        return 0;
    }
    if (!variable->is_input) {
        return instance_refuse(instance, "%s: %s is no input: only inputs are set", function, variable->name);
    }
    /* NaN fails both comparisons. */
    if (!(value >= -FLT_MAX && value <= FLT_MAX)) {
        return instance_refuse(instance, "%s: %s is to be %g: give a finite number in %s; nothing was set", function,
                               variable->name, value, variable->unit);
    }
    if (kind == INTEGER && value < 0.0) {
        return instance_refuse(instance, "%s: %s is to be %.0f: give a number from 0 on; nothing was set", function,
                               variable->name, value);
    }
    return 1;
}

/* Link to a saved state, in the list; its end if the pointer is no state of this instance. */
static State **find(Instance *instance, const void *state) {
    State **link = &instance->states;
    while (*link != NULL && *link != state) {
        link = &(*link)->next;
    }
    return link;
}

int instance_save(Instance *instance, void **state, const char *function) {
    State *saved;
    if (state == NULL) {
        return instance_refuse(instance, "%s: the pointer to the state is NULL", function);
    }
    if (*state != NULL) {
        saved = *find(instance, *state);
        if (saved == NULL) {
            return instance_refuse(instance, "%s: not a state of this instance: give a pointer to NULL for a new one", function);
        }
    } else {
        saved = malloc(sizeof *saved);
        if (saved == NULL) {
            return instance_refuse(instance, "%s: no memory for a state of %u bytes: free other states", function,
                                   (unsigned)sizeof *saved);
        }
        saved->next = instance->states;
        instance->states = saved;
        *state = saved;
    }
    memcpy(&saved->model, &instance->model, sizeof saved->model);
    return 1;
}

int instance_restore(Instance *instance, void *state, const char *function) {
    const State *const saved = *find(instance, state);
    if (saved == NULL) {
        return instance_refuse(instance, "%s: not a state of this instance, or a freed one: restore what this instance saved",
                               function);
    }
    memcpy(&instance->model, &saved->model, sizeof saved->model);
    return 1;
}

int instance_forget(Instance *instance, void **state, const char *function) {
    State **link;
    State *freed;
    if (state == NULL || *state == NULL) {
        return 1;
    }
    link = find(instance, *state);
    freed = *link;
    if (freed == NULL) {
        return instance_refuse(instance, "%s: not a state of this instance, or a freed one", function);
    }
    *link = freed->next;
    free(freed);
    *state = NULL;
    return 1;
}
