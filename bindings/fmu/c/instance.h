/*
 * Instance of a joint's FMU: the part that FMI 2 and FMI 3 share. Values of all variables stand in one array, indexed by
 * value reference; the library's objects lie beside them, so that a saved state is one copy. An instance has no globals.
 */
#ifndef INSTANCE_H
#define INSTANCE_H

#include <lostmotion/joint.h>

#include "description.h"

/* Stages of an instance, as bits of a set. */
enum { INSTANTIATED = 1, INITIALIZING = 2, STEPPING = 4, TERMINATED = 8, ANY_STAGE = 15 };

/* All that changes. The library's objects hold their own address: a copy is used only after it was copied back. */
typedef struct Model {
    double values[VARIABLES];
    /* Time of the first step [s], and control periods since. */
    double start_s;
    uint64_t periods;
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
    /* Reports an error to the importer. */
    void (*report)(const Instance *instance, const char *message);
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
/* Reports an error; returns 0. */
int instance_refuse(const Instance *instance, const char *format, ...);
/* Returns nonzero if a function may be called in the present stage; otherwise reports it. */
int instance_may(const Instance *instance, unsigned stages, const char *function);

int instance_initialize(Instance *instance, const char *function);
int instance_reset(Instance *instance);
/* Advances by a communication step, or reports why not and changes nothing. */
int instance_step(Instance *instance, double from_s, double step_s, const char *function);

/* Returns nonzero if variables of this kind may be read or set in this call. */
int instance_readable(const Instance *instance, Kind kind, const uint32_t *references, size_t count, const char *function);
int instance_settable(const Instance *instance, Kind kind, uint32_t reference, double value, const char *function);

int instance_save(Instance *instance, void **state, const char *function);
int instance_restore(Instance *instance, void *state, const char *function);
int instance_forget(Instance *instance, void **state, const char *function);

/* What plant.c or controller.c does: starts the objects, reads the inputs of one control period and advances, writes the
   outputs. */
JointStatus model_start(Model *model);
JointStatus model_period(Model *model);
JointStatus model_outputs(Model *model);

#endif
