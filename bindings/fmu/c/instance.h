/*
 * Instance of a joint's FMU: the part that FMI 2 and FMI 3 share. Values of all variables stand in one array, indexed by
 * value reference; the library's objects lie beside them, so that a saved state is one copy. An instance has no globals.
 */
#ifndef INSTANCE_H
#define INSTANCE_H

#include <lostmotion/joint.h>

#include "description.h"

#define TURN_RAD 6.283185307179586

/* Stages of an instance, as bits of a set. */
enum { INSTANTIATED = 1, INITIALIZING = 2, STEPPING = 4, TERMINATED = 8, ANY_STAGE = 15 };

/* Outcomes of a call: failed and reported; succeeded; refused and reported, to be tried again in another way. */
typedef enum { FAILED, SUCCEEDED, DISCARDED } Outcome;

/* Categories of messages, as bits of a set. */
enum { LOG_ERROR = 1, LOG_DISCARD = 2, LOG_ALL = 3 };

/* All that changes. The library's objects hold their own address: a copy is used only after it was copied back. */
typedef struct Model {
    double values[VARIABLES];
    /* Times of the first step and of the end [s]; the end is infinite if the importer names none. */
    double start_s;
    double stop_s;
    /* Control periods since the start, and at the begin of the communication step. */
    uint64_t periods;
    uint64_t step_began;
    unsigned stage;
    Objects objects;
} Model;

/* Saved state, in the list of its instance. */
typedef struct State {
    struct State *next;
    Model model;
} State;

typedef struct Instance Instance;
struct Instance {
    uint32_t mark;
    Model model;
    State *states;
    /* Categories that the importer wants to be told. */
    unsigned logged;
    /* Outcome of a refused step size or value: DISCARDED in FMI 3, FAILED in FMI 2. */
    Outcome refused;
    /* Reports an error or a discarded call to the importer. */
    void (*report)(const Instance *instance, Outcome outcome, const char *message);
    /* Logger and environment of the importer, for `report`. */
    void (*logger)(void);
    void *environment;
    char *name;
};

/* Creates an instance, or reports why not and returns NULL. */
Instance *instance_new(const Instance *callbacks, const char *name, const char *token);
void instance_free(void *pointer);
/* The instance behind an importer's pointer, or NULL. */
Instance *instance_at(void *pointer);
/* Reports a call that fails or is discarded, if its category is logged; returns the outcome. */
Outcome instance_refuse(const Instance *instance, Outcome outcome, const char *format, ...);
/* Sets the logged categories: those named, or all if none is. */
Outcome instance_log(Instance *instance, int on, size_t count, const char *const *categories, const char *function);
/* Succeeds if a function may be called in the present stage. */
Outcome instance_may(const Instance *instance, unsigned stages, const char *function);
/* Goes to a stage from others. */
Outcome instance_advance(Instance *instance, unsigned from, unsigned to, const char *function);

/* Stores start and end of the simulation. */
Outcome instance_set_times(Instance *instance, double start_s, int has_stop, double stop_s, const char *function);
Outcome instance_initialize(Instance *instance, const char *function);
Outcome instance_reset(Instance *instance);
/* Advances by a communication step, or reports why not and changes nothing. */
Outcome instance_step(Instance *instance, double from_s, double step_s, const char *function);

/* Succeeds if a call passes its arrays. */
Outcome instance_has_arrays(const Instance *instance, const void *references, const void *values, size_t count,
                            const char *function);
/* Succeeds if variables of this kind may be read or set in this call. */
Outcome instance_readable(const Instance *instance, Kind kind, const uint32_t *references, size_t count, const char *function);
Outcome instance_settable(const Instance *instance, Kind kind, uint32_t reference, double value, const char *function);

Outcome instance_save(Instance *instance, void **state, const char *function);
Outcome instance_restore(Instance *instance, void *state, const char *function);
Outcome instance_forget(Instance *instance, void **state, const char *function);

/* Functions of plant.c or controller.c: start the objects; read the inputs of one control period and advance; write the
   outputs. */
JointStatus model_start(Model *model);
JointStatus model_period(Model *model);
JointStatus model_outputs(Model *model);

/* Number of a contact: 1 drive side, -1 back side, 0 in the gap. */
static inline double side_of(JointContact contact) {
    return contact == JOINT_CONTACT_DRIVE_SIDE ? 1.0 : contact == JOINT_CONTACT_BACK_SIDE ? -1.0 : 0.0;
}

#endif
