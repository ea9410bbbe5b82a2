/* The functions of FMI 3.0 for co-simulation, over instance.h. */
#include "fmi3.h"

#include <string.h>

#include "instance.h"

/* Stages in which inputs may be set; values may be read in all. */
#define SETTING (INSTANTIATED | INITIALIZING | STEPPING)

static void report(const Instance *instance, Outcome outcome, const char *message) {
    /* The pointer was stored on instantiation, as a pointer of another type of function. */
    const fmi3LogMessageCallback logger = (fmi3LogMessageCallback)instance->logger;
    if (logger != NULL) {
        logger(instance->environment, outcome == DISCARDED ? fmi3Discard : fmi3Error,
               outcome == DISCARDED ? "logStatusDiscard" : "logStatusError", message);
    }
}

/* Status of a call; an error terminates the instance, as FMI 3 demands. */
static fmi3Status status_of(Instance *instance, Outcome outcome) {
    if (outcome == FAILED) {
        instance->model.stage = TERMINATED;
    }
    return outcome == SUCCEEDED ? fmi3OK : outcome == DISCARDED ? fmi3Discard : fmi3Error;
}

FMI3_EXPORT const char *fmi3GetVersion(void) {
    return "3.0";
}

FMI3_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[]) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi3Error : status_of(it, instance_log(it, on, count, categories, "fmi3SetDebugLogging"));
}

static Instance callbacks_of(fmi3String name, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger) {
    Instance callbacks;
    memset(&callbacks, 0, sizeof callbacks);
    callbacks.report = report;
    callbacks.refused = DISCARDED;
    /* A failed instantiation is always explained. */
    callbacks.logged = LOG_ALL;
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
    Instance *it;
    if (event_mode || intermediate_count > 0) {
        (void)instance_refuse(&callbacks, FAILED, "fmi3InstantiateCoSimulation: event mode and intermediate variables are not offered: "
                              "instantiate without them");
        return NULL;
    }
    it = instance_new(&callbacks, name, token);
    if (it != NULL) {
        it->logged = logging ? LOG_ALL : 0;
    }
    return it;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                                      fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                                      fmi3LogMessageCallback logger) {
    const Instance callbacks = callbacks_of(name, environment, logger);
    (void)instance_refuse(&callbacks, FAILED, "fmi3InstantiateModelExchange: instantiate for co-simulation");
    return NULL;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                           fmi3Boolean visible, fmi3Boolean logging,
                                                           fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                                           fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                                           fmi3LockPreemptionCallback unlock) {
    const Instance callbacks = callbacks_of(name, environment, logger);
    (void)instance_refuse(&callbacks, FAILED, "fmi3InstantiateScheduledExecution: instantiate for co-simulation");
    return NULL;
}

FMI3_EXPORT void fmi3FreeInstance(fmi3Instance c) {
    instance_free(c);
}

FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                                   fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop) {
    Instance *const it = instance_at(c);
    Outcome outcome;
    if (it == NULL) {
        return fmi3Error;
    }
    outcome = instance_set_times(it, start, has_stop, stop, "fmi3EnterInitializationMode");
    return status_of(it, outcome == SUCCEEDED ? instance_initialize(it, "fmi3EnterInitializationMode") : outcome);
}

FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi3Error : status_of(it, instance_advance(it, INITIALIZING, STEPPING, "fmi3ExitInitializationMode"));
}

FMI3_EXPORT fmi3Status fmi3Terminate(fmi3Instance c) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi3Error : status_of(it, instance_advance(it, STEPPING, TERMINATED, "fmi3Terminate"));
}

FMI3_EXPORT fmi3Status fmi3Reset(fmi3Instance c) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi3Error : status_of(it, instance_reset(it));
}

static Outcome check_arrays(const Instance *it, const fmi3ValueReference references[], size_t count, const void *values,
                            size_t value_count, const char *function) {
    if (count != value_count) {
        return instance_refuse(it, FAILED, "%s: %lu value references but %lu values: pass one value for every reference, as all "
                               "variables are scalars", function, (unsigned long)count, (unsigned long)value_count);
    }
    return instance_has_arrays(it, references, values, count, function);
}

/* Defines the functions that read and set variables of one type; nothing is set unless all can be. */
#define ACCESS(Type, KIND, as_value, as_type)                                                                               \
    FMI3_EXPORT fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference references[], size_t count,               \
                                         fmi3##Type values[], size_t value_count) {                                         \
        Instance *const it = instance_at(c);                                                                                \
        size_t index;                                                                                                       \
        if (it == NULL) {                                                                                                   \
            return fmi3Error;                                                                                               \
        }                                                                                                                   \
        if (check_arrays(it, references, count, values, value_count, "fmi3Get" #Type) != SUCCEEDED ||                       \
            instance_readable(it, KIND, references, count, "fmi3Get" #Type) != SUCCEEDED) {                                 \
            return status_of(it, FAILED);                                                                                   \
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
        if (it == NULL) {                                                                                                   \
            return fmi3Error;                                                                                               \
        }                                                                                                                   \
        if (instance_may(it, SETTING, "fmi3Set" #Type) != SUCCEEDED ||                                                      \
            check_arrays(it, references, count, values, value_count, "fmi3Set" #Type) != SUCCEEDED) {                       \
            return status_of(it, FAILED);                                                                                   \
        }                                                                                                                   \
        for (index = 0; index < count; index++) {                                                                           \
            const Outcome outcome = instance_settable(it, KIND, references[index], as_value, "fmi3Set" #Type);              \
            if (outcome != SUCCEEDED) {                                                                                     \
                return status_of(it, outcome);                                                                              \
            }                                                                                                               \
        }                                                                                                                   \
        for (index = 0; index < count; index++) {                                                                           \
            it->model.values[references[index]] = as_value;                                                                 \
        }                                                                                                                   \
        return fmi3OK;                                                                                                      \
    }

ACCESS(Float64, REAL, values[index], value)
ACCESS(Int32, INTEGER, (double)values[index], (fmi3Int32)value)
ACCESS(Boolean, BOOLEAN, values[index] ? 1.0 : 0.0, value != 0.0)

FMI3_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi3Error : status_of(it, instance_save(it, state, "fmi3GetFMUState"));
}

FMI3_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi3Error : status_of(it, instance_restore(it, state, "fmi3SetFMUState"));
}

FMI3_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
    Instance *const it = instance_at(c);
    return it == NULL ? fmi3Error : status_of(it, instance_forget(it, state, "fmi3FreeFMUState"));
}

FMI3_EXPORT fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 from, fmi3Float64 step, fmi3Boolean no_restore, fmi3Boolean *event,
                                  fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last_time) {
    Instance *const it = instance_at(c);
    const Outcome outcome = it == NULL ? FAILED : instance_step(it, from, step, "fmi3DoStep");
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
    return it == NULL ? fmi3Error : status_of(it, outcome);
}

/* Defines a function of the standard that this FMU does not offer. */
#define NOT_OFFERED(name, why, ...)                                                                                         \
    FMI3_EXPORT fmi3Status name(fmi3Instance c, __VA_ARGS__) {                                                              \
        Instance *const it = instance_at(c);                                                                                \
        return it == NULL ? fmi3Error : status_of(it, instance_refuse(it, FAILED, #name ": " why));                         \
    }
#define NOT_OFFERED_ALONE(name, why)                                                                                        \
    FMI3_EXPORT fmi3Status name(fmi3Instance c) {                                                                           \
        Instance *const it = instance_at(c);                                                                                \
        return it == NULL ? fmi3Error : status_of(it, instance_refuse(it, FAILED, #name ": " why));                         \
    }
#define NO_TYPE "no variable is of this type: take types from modelDescription.xml"
#define NO_VARIABLES(Type)                                                                                                  \
    NOT_OFFERED(fmi3Get##Type, NO_TYPE, const fmi3ValueReference references[], size_t count,  \
                fmi3##Type values[], size_t value_count)                                                                    \
    NOT_OFFERED(fmi3Set##Type, NO_TYPE, const fmi3ValueReference references[], size_t count,  \
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

#define NO_CLOCKS "there are no clocks: call fmi3DoStep"
#define NO_EVENTS "there are no events: call fmi3DoStep"
#define NO_BYTES "a saved state stays in its instance: restore it with fmi3SetFMUState"
#define NO_DERIVATIVES "there are no derivatives: inputs are held over a communication step; shorten the step"
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
NOT_OFFERED_ALONE(fmi3EnterConfigurationMode, "there are no structural parameters: export the joint again")
NOT_OFFERED_ALONE(fmi3ExitConfigurationMode, "there are no structural parameters: export the joint again")
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
