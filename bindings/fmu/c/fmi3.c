/* The functions of FMI 3.0 for co-simulation, over instance.h. */
#include "fmi3.h"

#include <string.h>

#include "instance.h"

/* Stages in which inputs may be set; values may be read in all. */
#define SETTING (INSTANTIATED | INITIALIZING | STEPPING)

static void report(const Instance *instance, const char *message) {
    /* The pointer was stored on instantiation, as a pointer of another type of function. */
    const fmi3LogMessageCallback logger = (fmi3LogMessageCallback)instance->logger;
    if (logger != NULL) {
        logger(instance->environment, fmi3Error, "logStatusError", message);
    }
}

static fmi3Status status_of(int succeeded) {
    return succeeded ? fmi3OK : fmi3Error;
}

FMI3_EXPORT const char *fmi3GetVersion(void) {
    return "3.0";
}

FMI3_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[]) {
    /* Errors are always reported; there is nothing else to report. */
    return status_of(instance_at(c) != NULL);
}

static Instance callbacks_of(fmi3String name, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger) {
    Instance callbacks;
    memset(&callbacks, 0, sizeof callbacks);
    callbacks.report = report;
    callbacks.name = (char *)(name == NULL ? "" : name);
    callbacks.logger = (void (*)(void))logger;
    callbacks.environment = environment;
    return callbacks;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                                     fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
                                                     const fmi3ValueReference intermediate[], size_t intermediate_count,
                                                     fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                                     fmi3IntermediateUpdateCallback update) {
    const Instance callbacks = callbacks_of(name, environment, logger);
    if (event_mode || intermediate_count > 0) {
        (void)instance_refuse(&callbacks, "fmi3InstantiateCoSimulation: event mode and intermediate variables are not offered: "
                              "instantiate without them");
        return NULL;
    }
    return instance_new(&callbacks, name, token);
}

FMI3_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                                      fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                                      fmi3LogMessageCallback logger) {
    const Instance callbacks = callbacks_of(name, environment, logger);
    (void)instance_refuse(&callbacks, "fmi3InstantiateModelExchange: instantiate for co-simulation");
    return NULL;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                           fmi3Boolean visible, fmi3Boolean logging,
                                                           fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                                           fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                                           fmi3LockPreemptionCallback unlock) {
    const Instance callbacks = callbacks_of(name, environment, logger);
    (void)instance_refuse(&callbacks, "fmi3InstantiateScheduledExecution: instantiate for co-simulation");
    return NULL;
}

FMI3_EXPORT void fmi3FreeInstance(fmi3Instance c) {
    instance_free(c);
}

FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                                   fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop) {
    Instance *const it = instance_at(c);
    if (it == NULL || !instance_may(it, INSTANTIATED, "fmi3EnterInitializationMode")) {
        return fmi3Error;
    }
    if (!(start > -1e12 && start < 1e12)) {
        return status_of(instance_refuse(it, "fmi3EnterInitializationMode: start time %g s: give a finite time", start));
    }
    it->model.start_s = start;
    return status_of(instance_initialize(it, "fmi3EnterInitializationMode"));
}

/* Goes to a stage from others. */
static fmi3Status advance(fmi3Instance c, unsigned from, unsigned to, const char *function) {
    Instance *const it = instance_at(c);
    if (it == NULL || !instance_may(it, from, function)) {
        return fmi3Error;
    }
    it->model.stage = to;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    return advance(c, INITIALIZING, STEPPING, "fmi3ExitInitializationMode");
}

FMI3_EXPORT fmi3Status fmi3Terminate(fmi3Instance c) {
    return advance(c, STEPPING, TERMINATED, "fmi3Terminate");
}

FMI3_EXPORT fmi3Status fmi3Reset(fmi3Instance c) {
    Instance *const it = instance_at(c);
    return status_of(it != NULL && instance_reset(it));
}

/* Defines the functions that read and set variables of one type; nothing is set unless all can be. */
#define ACCESS(Type, KIND, as_value, as_type)                                                                               \
    FMI3_EXPORT fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference references[], size_t count,               \
                                         fmi3##Type values[], size_t value_count) {                                         \
        Instance *const it = instance_at(c);                                                                                \
        size_t index;                                                                                                       \
        if (it == NULL || !same_count(it, count, value_count, "fmi3Get" #Type) ||                                           \
            !instance_readable(it, KIND, references, count, "fmi3Get" #Type)) {                                             \
            return fmi3Error;                                                                                               \
        }                                                                                                                   \
        for (index = 0; index < count; index++) {                                                                           \
            const double value = it->model.values[references[index]];                                                       \
            values[index] = as_type;                                                                                        \
        }                                                                                                                   \
        return fmi3OK;                                                                                                      \
    }                                                                                                                       \
    FMI3_EXPORT fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference references[], size_t count,               \
                                         const fmi3##Type values[], size_t value_count) {                                   \
        Instance *const it = instance_at(c);                                                                                \
        size_t index;                                                                                                       \
        if (it == NULL || !instance_may(it, SETTING, "fmi3Set" #Type) ||                                                    \
            !same_count(it, count, value_count, "fmi3Set" #Type)) {                                                         \
            return fmi3Error;                                                                                               \
        }                                                                                                                   \
        for (index = 0; index < count; index++) {                                                                           \
            if (!instance_settable(it, KIND, references[index], as_value, "fmi3Set" #Type)) {                               \
                return fmi3Error;                                                                                           \
            }                                                                                                               \
        }                                                                                                                   \
        for (index = 0; index < count; index++) {                                                                           \
            it->model.values[references[index]] = as_value;                                                                 \
        }                                                                                                                   \
        return fmi3OK;                                                                                                      \
    }

static int same_count(const Instance *it, size_t references, size_t values, const char *function) {
    return references == values ||
           instance_refuse(it, "%s: %u value references but %u values: every variable here is a scalar", function,
                           (unsigned)references, (unsigned)values);
}

ACCESS(Float64, REAL, values[index], value)
ACCESS(Int32, INTEGER, (double)values[index], (fmi3Int32)value)
ACCESS(Boolean, BOOLEAN, values[index] ? 1.0 : 0.0, value != 0.0)

FMI3_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) {
    Instance *const it = instance_at(c);
    return status_of(it != NULL && instance_save(it, state, "fmi3GetFMUState"));
}

FMI3_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
    Instance *const it = instance_at(c);
    return status_of(it != NULL && instance_restore(it, state, "fmi3SetFMUState"));
}

FMI3_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
    Instance *const it = instance_at(c);
    return status_of(it != NULL && instance_forget(it, state, "fmi3FreeFMUState"));
}

FMI3_EXPORT fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 from, fmi3Float64 step, fmi3Boolean no_restore, fmi3Boolean *event,
                                  fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last_time) {
    Instance *const it = instance_at(c);
    const int succeeded = it != NULL && instance_step(it, from, step, "fmi3DoStep");
    if (event != NULL) {
        *event = false;
    }
    if (terminate != NULL) {
        *terminate = false;
    }
    if (early != NULL) {
        *early = false;
    }
    if (it != NULL && last_time != NULL) {
        *last_time = it->model.values[VALUE_time];
    }
    return status_of(succeeded);
}

/* Defines a function of the standard that this FMU does not offer. */
#define NOT_OFFERED(name, why, ...)                                                                                         \
    FMI3_EXPORT fmi3Status name(fmi3Instance c, __VA_ARGS__) {                                                              \
        Instance *const it = instance_at(c);                                                                                \
        return status_of(it != NULL && instance_refuse(it, #name ": " why));                                                \
    }
#define NOT_OFFERED_ALONE(name, why)                                                                                        \
    FMI3_EXPORT fmi3Status name(fmi3Instance c) {                                                                           \
        Instance *const it = instance_at(c);                                                                                \
        return status_of(it != NULL && instance_refuse(it, #name ": " why));                                                \
    }
#define NO_VARIABLES(Type)                                                                                                  \
    NOT_OFFERED(fmi3Get##Type, "there are no variables of this type", const fmi3ValueReference references[], size_t count,  \
                fmi3##Type values[], size_t value_count)                                                                    \
    NOT_OFFERED(fmi3Set##Type, "there are no variables of this type", const fmi3ValueReference references[], size_t count,  \
                const fmi3##Type values[], size_t value_count)

NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(UInt32)
NO_VARIABLES(Int64)
NO_VARIABLES(UInt64)
NO_VARIABLES(String)

#define NO_TYPE "there are no variables of this type"
#define NO_CLOCKS "there are no clocks"
#define NO_EVENTS "there are no events: call fmi3DoStep"
#define NO_BYTES "a saved state belongs to its instance and is not turned into bytes"
#define NO_DERIVATIVES "there are no derivatives: inputs are held over a communication step"
#define REFERENCES const fmi3ValueReference references[], size_t count

NOT_OFFERED(fmi3GetBinary, NO_TYPE, REFERENCES, size_t sizes[], fmi3Binary values[], size_t value_count)
NOT_OFFERED(fmi3SetBinary, NO_TYPE, REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t value_count)
NOT_OFFERED(fmi3GetClock, NO_CLOCKS, REFERENCES, fmi3Clock values[])
NOT_OFFERED(fmi3SetClock, NO_CLOCKS, REFERENCES, const fmi3Clock values[])
NOT_OFFERED(fmi3GetIntervalDecimal, NO_CLOCKS, REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
NOT_OFFERED(fmi3GetIntervalFraction, NO_CLOCKS, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
            fmi3IntervalQualifier qualifiers[])
NOT_OFFERED(fmi3GetShiftDecimal, NO_CLOCKS, REFERENCES, fmi3Float64 shifts[])
NOT_OFFERED(fmi3GetShiftFraction, NO_CLOCKS, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
NOT_OFFERED(fmi3SetIntervalDecimal, NO_CLOCKS, REFERENCES, const fmi3Float64 intervals[])
NOT_OFFERED(fmi3SetIntervalFraction, NO_CLOCKS, REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NOT_OFFERED(fmi3SetShiftDecimal, NO_CLOCKS, REFERENCES, const fmi3Float64 shifts[])
NOT_OFFERED(fmi3SetShiftFraction, NO_CLOCKS, REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NOT_OFFERED(fmi3ActivateModelPartition, NO_CLOCKS, fmi3ValueReference clock, fmi3Float64 time)
NOT_OFFERED_ALONE(fmi3EnterEventMode, NO_EVENTS)
NOT_OFFERED_ALONE(fmi3EnterStepMode, NO_EVENTS)
NOT_OFFERED_ALONE(fmi3EvaluateDiscreteStates, NO_EVENTS)
NOT_OFFERED(fmi3UpdateDiscreteStates, NO_EVENTS, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals_changed,
            fmi3Boolean *values_changed, fmi3Boolean *has_next, fmi3Float64 *next)
NOT_OFFERED_ALONE(fmi3EnterConfigurationMode, "there are no structural parameters")
NOT_OFFERED_ALONE(fmi3ExitConfigurationMode, "there are no structural parameters")
NOT_OFFERED(fmi3SerializedFMUStateSize, NO_BYTES, fmi3FMUState state, size_t *size)
NOT_OFFERED(fmi3SerializeFMUState, NO_BYTES, fmi3FMUState state, fmi3Byte bytes[], size_t size)
NOT_OFFERED(fmi3DeserializeFMUState, NO_BYTES, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
NOT_OFFERED(fmi3GetNumberOfVariableDependencies, NO_DERIVATIVES, fmi3ValueReference reference, size_t *count)
NOT_OFFERED(fmi3GetVariableDependencies, NO_DERIVATIVES, fmi3ValueReference dependent, size_t of_dependent[],
            fmi3ValueReference independents[], size_t of_independents[], fmi3DependencyKind kinds[], size_t count)
NOT_OFFERED(fmi3GetDirectionalDerivative, NO_DERIVATIVES, const fmi3ValueReference unknowns[], size_t unknown_count,
            const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[], size_t seed_count,
            fmi3Float64 sensitivity[], size_t sensitivity_count)
NOT_OFFERED(fmi3GetAdjointDerivative, NO_DERIVATIVES, const fmi3ValueReference unknowns[], size_t unknown_count,
            const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[], size_t seed_count,
            fmi3Float64 sensitivity[], size_t sensitivity_count)
NOT_OFFERED(fmi3GetOutputDerivatives, NO_DERIVATIVES, REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[],
            size_t value_count)

/* Importers look for all functions of the standard, those of model exchange among them. */
#define NO_EXCHANGE "model exchange is not offered: instantiate for co-simulation"

NOT_OFFERED_ALONE(fmi3EnterContinuousTimeMode, NO_EXCHANGE)
NOT_OFFERED(fmi3CompletedIntegratorStep, NO_EXCHANGE, fmi3Boolean no_restore, fmi3Boolean *enter_event_mode, fmi3Boolean *terminate)
NOT_OFFERED(fmi3SetTime, NO_EXCHANGE, fmi3Float64 time)
NOT_OFFERED(fmi3SetContinuousStates, NO_EXCHANGE, const fmi3Float64 states[], size_t count)
NOT_OFFERED(fmi3GetContinuousStates, NO_EXCHANGE, fmi3Float64 states[], size_t count)
NOT_OFFERED(fmi3GetContinuousStateDerivatives, NO_EXCHANGE, fmi3Float64 derivatives[], size_t count)
NOT_OFFERED(fmi3GetNominalsOfContinuousStates, NO_EXCHANGE, fmi3Float64 nominals[], size_t count)
NOT_OFFERED(fmi3GetEventIndicators, NO_EXCHANGE, fmi3Float64 indicators[], size_t count)
NOT_OFFERED(fmi3GetNumberOfEventIndicators, NO_EXCHANGE, size_t *count)
NOT_OFFERED(fmi3GetNumberOfContinuousStates, NO_EXCHANGE, size_t *count)
