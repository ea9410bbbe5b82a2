/* The functions of FMI 2.0 for co-simulation, over instance.h. */
#include "fmi2.h"

#include <string.h>

#include "instance.h"

/* Stages in which FMI 2 allows values to be read, and inputs to be set. */
#define READING (INITIALIZING | STEPPING | TERMINATED)
#define SETTING (INSTANTIATED | INITIALIZING | STEPPING)

static void report(const Instance *instance, Outcome outcome, const char *message) {
    /* The pointer was stored by fmi2Instantiate, as a pointer of another type of function. */
    const fmi2CallbackLogger logger = (fmi2CallbackLogger)instance->logger;
    if (logger != NULL) {
        logger(instance->environment, instance->name, outcome == DISCARDED ? fmi2Discard : fmi2Error,
               outcome == DISCARDED ? "logStatusDiscard" : "logStatusError", "%s", message);
    }
}

static fmi2Status status_of(Outcome outcome) {
    return outcome == SUCCEEDED ? fmi2OK : outcome == DISCARDED ? fmi2Discard : fmi2Error;
}

FMI2_EXPORT const char *fmi2GetTypesPlatform(void) {
    return "default";
}

FMI2_EXPORT const char *fmi2GetVersion(void) {
    return "2.0";
}

FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[]) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi2Error : status_of(instance_log(it, on, count, categories, "fmi2SetDebugLogging"));
}

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                                          const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    Instance callbacks, *it;
    memset(&callbacks, 0, sizeof callbacks);
    callbacks.report = report;
    callbacks.refused = FAILED;
    /* A failed instantiation is always explained. */
    callbacks.logged = LOG_ALL;
    callbacks.name = (char *)(name == NULL ? "" : name);
    if (functions != NULL) {
        callbacks.logger = (void (*)(void))functions->logger;
        callbacks.environment = functions->componentEnvironment;
    }
    if (type != fmi2CoSimulation) {
        (void)instance_refuse(&callbacks, FAILED, "fmi2Instantiate: model exchange is not offered: instantiate for co-simulation");
        return NULL;
    }
    it = instance_new(&callbacks, name, token);
    if (it != NULL) {
        it->logged = logging ? LOG_ALL : 0;
    }
    return it;
}

FMI2_EXPORT void fmi2FreeInstance(fmi2Component c) {
    instance_free(c);
}

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                                           fmi2Boolean has_stop, fmi2Real stop) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi2Error : status_of(instance_set_times(it, start, has_stop, stop, "fmi2SetupExperiment"));
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi2Error : status_of(instance_initialize(it, "fmi2EnterInitializationMode"));
}

FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi2Error : status_of(instance_advance(it, INITIALIZING, STEPPING, "fmi2ExitInitializationMode"));
}

FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component c) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi2Error : status_of(instance_advance(it, STEPPING, TERMINATED, "fmi2Terminate"));
}

FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component c) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi2Error : status_of(instance_reset(it));
}

/* Defines the functions that read and set variables of one kind; nothing is set unless all can be. */
#define ACCESS(Type, KIND, as_value, as_type)                                                                               \
    FMI2_EXPORT fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference references[], size_t count,              \
                                         fmi2##Type values[]) {                                                             \
        Instance *const it = instance_at(c);                                                                                \
        size_t index;                                                                                                       \
        if (it == NULL || instance_may(it, READING, "fmi2Get" #Type) != SUCCEEDED ||                                        \
            instance_has_arrays(it, references, values, count, "fmi2Get" #Type) != SUCCEEDED ||                             \
            instance_readable(it, KIND, references, count, "fmi2Get" #Type) != SUCCEEDED) {                                 \
            return fmi2Error;                                                                                               \
        }                                                                                                                   \
        for (index = 0; index < count; index++) {                                                                           \
            const double value = it->model.values[references[index]];                                                       \
            values[index] = as_type;                                                                                        \
        }                                                                                                                   \
        return fmi2OK;                                                                                                      \
    }                                                                                                                       \
    FMI2_EXPORT fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference references[], size_t count,              \
                                         const fmi2##Type values[]) {                                                       \
        Instance *const it = instance_at(c);                                                                                \
        size_t index;                                                                                                       \
        if (it == NULL || instance_may(it, SETTING, "fmi2Set" #Type) != SUCCEEDED ||                                        \
            instance_has_arrays(it, references, values, count, "fmi2Set" #Type) != SUCCEEDED) {                             \
            return fmi2Error;                                                                                               \
        }                                                                                                                   \
        for (index = 0; index < count; index++) {                                                                           \
            const Outcome outcome = instance_settable(it, KIND, references[index], as_value, "fmi2Set" #Type);              \
            if (outcome != SUCCEEDED) {                                                                                     \
                return status_of(outcome);                                                                                  \
            }                                                                                                               \
        }                                                                                                                   \
        for (index = 0; index < count; index++) {                                                                           \
            it->model.values[references[index]] = as_value;                                                                 \
        }                                                                                                                   \
        return fmi2OK;                                                                                                      \
    }

ACCESS(Real, REAL, values[index], value)
ACCESS(Integer, INTEGER, (double)values[index], (fmi2Integer)value)
ACCESS(Boolean, BOOLEAN, values[index] != 0 ? 1.0 : 0.0, value != 0.0)

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi2Error : status_of(instance_save(it, state, "fmi2GetFMUstate"));
}

FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi2Error : status_of(instance_restore(it, state, "fmi2SetFMUstate"));
}

FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi2Error : status_of(instance_forget(it, state, "fmi2FreeFMUstate"));
}

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real from, fmi2Real step, fmi2Boolean no_restore) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi2Error : status_of(instance_step(it, from, step, "fmi2DoStep"));
}

FMI2_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    Instance *const it = instance_at(c);
    if (it == NULL || value == NULL) {
        return fmi2Error;
    }
    if (kind != fmi2LastSuccessfulTime) {
        return status_of(instance_refuse(it, DISCARDED, "fmi2GetRealStatus: ask for fmi2LastSuccessfulTime, the only real number"));
    }
    *value = it->model.values[VALUE_time];
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    Instance *const it = instance_at(c);
    if (it == NULL || value == NULL) {
        return fmi2Error;
    }
    if (kind != fmi2Terminated) {
        return status_of(instance_refuse(it, DISCARDED, "fmi2GetBooleanStatus: ask for fmi2Terminated, the only truth value"));
    }
    /* This model never ends a simulation by itself. */
    *value = 0;
    return fmi2OK;
}

/* Defines a function of the standard that this FMU does not offer. */
#define REFUSED(outcome, name, why, ...)                                                                                    \
    FMI2_EXPORT fmi2Status name(fmi2Component c, __VA_ARGS__) {                                                             \
        Instance *const it = instance_at(c);                                                                                \
        return it == NULL ? fmi2Error : status_of(instance_refuse(it, outcome, #name ": " why));                            \
    }
#define NOT_OFFERED(name, why, ...) REFUSED(FAILED, name, why, __VA_ARGS__)

#define NO_STRINGS "there are no strings: take types from modelDescription.xml"
#define NOT_ASYNCHRONOUS "every step is over when fmi2DoStep returns: use its status"
#define NO_BYTES "a saved state stays in its instance: restore it with fmi2SetFMUstate"
#define NO_DERIVATIVES "there are no derivatives: inputs are held over a communication step; shorten the step"

NOT_OFFERED(fmi2GetString, NO_STRINGS, const fmi2ValueReference references[], size_t count, fmi2String values[])
NOT_OFFERED(fmi2SetString, NO_STRINGS, const fmi2ValueReference references[], size_t count, const fmi2String values[])
NOT_OFFERED(fmi2SerializedFMUstateSize, NO_BYTES, fmi2FMUstate state, size_t *size)
NOT_OFFERED(fmi2SerializeFMUstate, NO_BYTES, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
NOT_OFFERED(fmi2DeSerializeFMUstate, NO_BYTES, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
NOT_OFFERED(fmi2GetDirectionalDerivative, NO_DERIVATIVES, const fmi2ValueReference unknowns[], size_t unknown_count,
            const fmi2ValueReference knowns[], size_t known_count, const fmi2Real seed[], fmi2Real derivatives[])
NOT_OFFERED(fmi2SetRealInputDerivatives, NO_DERIVATIVES, const fmi2ValueReference references[], size_t count,
            const fmi2Integer orders[], const fmi2Real values[])
NOT_OFFERED(fmi2GetRealOutputDerivatives, NO_DERIVATIVES, const fmi2ValueReference references[], size_t count,
            const fmi2Integer orders[], fmi2Real values[])
REFUSED(DISCARDED, fmi2GetStatus, NOT_ASYNCHRONOUS, const fmi2StatusKind kind, fmi2Status *value)
REFUSED(DISCARDED, fmi2GetIntegerStatus, NOT_ASYNCHRONOUS, const fmi2StatusKind kind, fmi2Integer *value)
REFUSED(DISCARDED, fmi2GetStringStatus, NOT_ASYNCHRONOUS, const fmi2StatusKind kind, fmi2String *value)

FMI2_EXPORT fmi2Status fmi2CancelStep(fmi2Component c) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi2Error : status_of(instance_refuse(it, FAILED, "fmi2CancelStep: " NOT_ASYNCHRONOUS));
}
