/* One set of calls for FMI 2 and FMI 3, found in a shared library at run time as an importer does. FMI is 2 or 3. */
#ifndef MASTER_H
#define MASTER_H

#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if FMI == 2
#include "fmi2.h"
#define PREFIX "fmi2"
#define REAL_TYPE "Real"
#define INTEGER_TYPE "Integer"
#define STATE "FMUstate"
typedef int Truth;
#define COUNT(count)
#define COUNTS
#else
#include "fmi3.h"
#define PREFIX "fmi3"
#define REAL_TYPE "Float64"
#define INTEGER_TYPE "Int32"
#define STATE "FMUState"
typedef bool Truth;
#define COUNT(count) , (size_t)(count)
#define COUNTS , size_t
#endif

/* Statuses; FMI 2 has no discarded steps and values here. */
enum { DONE = 0, DISCARD = 2, REFUSED = 3, BAD_VALUE = FMI == 2 ? REFUSED : DISCARD };

typedef struct {
    void *library;
    const char *token;
    int (*get_real)(void *, const uint32_t *, size_t, double *COUNTS);
    int (*set_real)(void *, const uint32_t *, size_t, const double *COUNTS);
    int (*get_integer)(void *, const uint32_t *, size_t, int *COUNTS);
    int (*set_integer)(void *, const uint32_t *, size_t, const int *COUNTS);
    int (*get_boolean)(void *, const uint32_t *, size_t, Truth *COUNTS);
    int (*set_boolean)(void *, const uint32_t *, size_t, const Truth *COUNTS);
    int (*initialized)(void *), (*terminate)(void *), (*reset)(void *);
    int (*save)(void *, void **), (*restore)(void *, void *), (*forget)(void *, void **);
    int (*log)(void *, Truth, size_t, const char *const *);
    void (*free)(void *);
} Unit;

/* Functions are fetched into pointers of their type through memory: C has no cast from data to functions. */
static void fetch(void *library, const char *name, void *place) {
    void *const found = dlsym(library, name);
    if (found == NULL) {
        printf("no function %s\n", name);
        exit(1);
    }
    memcpy(place, &found, sizeof found);
}

static Unit load(const char *path, const char *token) {
    Unit unit;
    unit.token = token;
    unit.library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (unit.library == NULL) {
        printf("%s\n", dlerror());
        exit(1);
    }
    fetch(unit.library, PREFIX "Get" REAL_TYPE, &unit.get_real);
    fetch(unit.library, PREFIX "Set" REAL_TYPE, &unit.set_real);
    fetch(unit.library, PREFIX "Get" INTEGER_TYPE, &unit.get_integer);
    fetch(unit.library, PREFIX "Set" INTEGER_TYPE, &unit.set_integer);
    fetch(unit.library, PREFIX "GetBoolean", &unit.get_boolean);
    fetch(unit.library, PREFIX "SetBoolean", &unit.set_boolean);
    fetch(unit.library, PREFIX "ExitInitializationMode", &unit.initialized);
    fetch(unit.library, PREFIX "Terminate", &unit.terminate);
    fetch(unit.library, PREFIX "Reset", &unit.reset);
    fetch(unit.library, PREFIX "Get" STATE, &unit.save);
    fetch(unit.library, PREFIX "Set" STATE, &unit.restore);
    fetch(unit.library, PREFIX "Free" STATE, &unit.forget);
    fetch(unit.library, PREFIX "SetDebugLogging", &unit.log);
    fetch(unit.library, PREFIX "FreeInstance", &unit.free);
    return unit;
}

/* The last message of an FMU, its status and category. */
static char message[512], told_category[32];
static int told_status;

#if FMI == 2
static void logged(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String format, ...) {
    __builtin_va_list arguments;
    (void)environment, (void)name;
    told_status = status;
    (void)snprintf(told_category, sizeof told_category, "%s", category);
    __builtin_va_start(arguments, format);
    (void)vsnprintf(message, sizeof message, format, arguments);
    __builtin_va_end(arguments);
}

static void *instantiate_with(const Unit *unit, const char *token, int logging) {
    static const fmi2CallbackFunctions callbacks = {logged, calloc, free, NULL, NULL};
    void *(*function)(const char *, int, const char *, const char *, const void *, int, int);
    fetch(unit->library, "fmi2Instantiate", &function);
    return function("joint", fmi2CoSimulation, token, "", &callbacks, 0, logging);
}

static int initialize_until(const Unit *unit, void *instance, double start, int has_stop, double stop) {
    int (*setup)(void *, int, double, double, int, double), (*enter)(void *);
    fetch(unit->library, "fmi2SetupExperiment", &setup);
    fetch(unit->library, "fmi2EnterInitializationMode", &enter);
    {
        const int first = setup(instance, 0, 0.0, start, has_stop, stop), second = enter(instance);
        return first > second ? first : second;
    }
}

static int step(const Unit *unit, void *instance, double from, double size) {
    static void *of;
    static int (*function)(void *, double, double, int);
    if (of != unit->library) {
        fetch(unit->library, "fmi2DoStep", &function);
        of = unit->library;
    }
    return function(instance, from, size, 1);
}
#else
static void logged(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text) {
    (void)environment;
    told_status = status;
    (void)snprintf(told_category, sizeof told_category, "%s", category);
    (void)snprintf(message, sizeof message, "%s", text);
}

static void *instantiate_with(const Unit *unit, const char *token, int logging) {
    void *(*function)(const char *, const char *, const char *, bool, bool, bool, bool, const void *, size_t, void *,
                      fmi3LogMessageCallback, void *);
    fetch(unit->library, "fmi3InstantiateCoSimulation", &function);
    return function("joint", token, "", false, logging != 0, false, false, NULL, 0, NULL, logged, NULL);
}

static int initialize_until(const Unit *unit, void *instance, double start, int has_stop, double stop) {
    int (*enter)(void *, bool, double, double, bool, double);
    fetch(unit->library, "fmi3EnterInitializationMode", &enter);
    return enter(instance, false, 0.0, start, has_stop != 0, stop);
}

static int step(const Unit *unit, void *instance, double from, double size) {
    static void *of;
    static int (*function)(void *, double, double, bool, bool *, bool *, bool *, double *);
    bool event, terminate, early;
    double last;
    if (of != unit->library) {
        fetch(unit->library, "fmi3DoStep", &function);
        of = unit->library;
    }
    return function(instance, from, size, true, &event, &terminate, &early, &last);
}
#endif

static void *instantiate(const Unit *unit, const char *token) {
    return instantiate_with(unit, token, 1);
}

static int initialize(const Unit *unit, void *instance, double start) {
    return initialize_until(unit, instance, start, 0, 0.0);
}

static int set_real(const Unit *unit, void *instance, uint32_t reference, double value) {
    return unit->set_real(instance, &reference, 1, &value COUNT(1));
}

static int set_integer(const Unit *unit, void *instance, uint32_t reference, int value) {
    return unit->set_integer(instance, &reference, 1, &value COUNT(1));
}

static int set_boolean(const Unit *unit, void *instance, uint32_t reference, int value) {
    const Truth truth = value != 0;
    return unit->set_boolean(instance, &reference, 1, &truth COUNT(1));
}

/* Value of a variable of any type; ends the program if the FMU refuses. */
static double value_of(const Unit *unit, void *instance, uint32_t reference, char kind) {
    double real = 0.0;
    int integer = 0, status;
    Truth truth = 0;
    if (kind == 'r') {
        status = unit->get_real(instance, &reference, 1, &real COUNT(1));
    } else if (kind == 'i') {
        status = unit->get_integer(instance, &reference, 1, &integer COUNT(1));
        real = (double)integer;
    } else {
        status = unit->get_boolean(instance, &reference, 1, &truth COUNT(1));
        real = truth ? 1.0 : 0.0;
    }
    if (status != DONE) {
        printf("value %u: %s\n", (unsigned)reference, message);
        exit(1);
    }
    return real;
}

/* Adds a number to a running digest, as model-core/src/numbers/digest.rs does. */
static uint64_t chain(uint64_t running, double number) {
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return (((running << 5) | (running >> 59)) ^ bits) * 0x9e3779b97f4a7c15ull;
}

#endif
