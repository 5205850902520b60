/* The functions of FMI 3.0 for co-simulation, as the standard declares them; what they do is in instance.h. */

#include <stdbool.h>

#define TOKEN "instantiation token"
#include "instance.h"

typedef uint32_t Reference;
typedef enum { OK, WARNING, DISCARD, ERROR, FATAL } Status;
typedef void (*Logger)(void *environment, Status status, const char *category, const char *message);

static void say(const Instance *instance, const char *text) {
    if (instance->logger != NULL) ((Logger)instance->logger)(instance->environment, ERROR, "logStatusError", text);
}

static Status status_of(int is_done) { return is_done ? OK : ERROR; }
static Status not_offered(void *c) { return status_of(complain(c, "The model description does not offer this.")); }

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

EXPORT Status fmi3SetDebugLogging(void *c, bool is_on, size_t count, const char *const categories[]) {
    (void)c, (void)is_on, (void)count, (void)categories; /* errors are told always, and there is nothing else to tell */
    return OK;
}

EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool is_visible,
                                         bool is_logging, bool has_events, bool may_return_early,
                                         const Reference required[], size_t n_required, void *environment, Logger logger,
                                         void *intermediate) {
    (void)resources, (void)is_visible, (void)is_logging, (void)may_return_early, (void)required, (void)n_required;
    (void)intermediate;
    if (name == NULL || token == NULL) return NULL;
    Instance told = {.logger = (void *)logger, .environment = environment, .name = (char *)name, .release = free};
    if (has_events) {
        complain(&told, "This FMU has no events.");
        return NULL;
    }
    return created(&told, token, calloc);
}

static void *co_simulation_only(void *environment, Logger logger) {
    Instance told = {.logger = (void *)logger, .environment = environment};
    complain(&told, "This FMU is for co-simulation only.");
    return NULL;
}

EXPORT void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *resources, bool is_visible,
                                          bool is_logging, void *environment, Logger logger) {
    (void)name, (void)token, (void)resources, (void)is_visible, (void)is_logging;
    return co_simulation_only(environment, logger);
}

EXPORT void *fmi3InstantiateScheduledExecution(const char *name, const char *token, const char *resources, bool is_visible,
                                               bool is_logging, void *environment, Logger logger, void *clock_update,
                                               void *lock, void *unlock) {
    (void)name, (void)token, (void)resources, (void)is_visible, (void)is_logging, (void)clock_update, (void)lock, (void)unlock;
    return co_simulation_only(environment, logger);
}

EXPORT void fmi3FreeInstance(void *c) { destroy(c); }

EXPORT Status fmi3EnterInitializationMode(void *c, bool has_tolerance, double tolerance, double start, bool has_stop, double stop) {
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    return status_of(set_time(c, start) && enter(c));
}

EXPORT Status fmi3ExitInitializationMode(void *c) { return status_of(leave(c)); }

EXPORT Status fmi3Terminate(void *c) {
    terminate(c);
    return OK;
}

EXPORT Status fmi3Reset(void *c) {
    reset(c);
    return OK;
}

static int is_count_right(void *c, size_t count, size_t n_values) {
    return count == n_values || complain(c, "There must be one value for each of the %zu variables, got %zu.", count, n_values);
}

EXPORT Status fmi3GetFloat64(void *c, const Reference references[], size_t count, double values[], size_t n_values) {
    if (!is_count_right(c, count, n_values)) return ERROR;
    for (size_t i = 0; i < count; i++)
        if (!look(c, references[i], &values[i])) return ERROR;
    return OK;
}

EXPORT Status fmi3SetFloat64(void *c, const Reference references[], size_t count, const double values[], size_t n_values) {
    if (!is_count_right(c, count, n_values)) return ERROR;
    for (size_t i = 0; i < count; i++)
        if (!put(c, references[i], values[i])) return ERROR;
    return OK;
}

static Status no_such_type(void *c, size_t count) {
    return status_of(count == 0 || complain(c, "All variables of this FMU are of type Float64."));
}

#define OTHER_TYPE(NAME, TYPE)                                                                                          \
    EXPORT Status fmi3Get##NAME(void *c, const Reference references[], size_t count, TYPE values[], size_t n_values) {   \
        (void)references, (void)values, (void)n_values;                                                                 \
        return no_such_type(c, count);                                                                                  \
    }                                                                                                                   \
    EXPORT Status fmi3Set##NAME(void *c, const Reference references[], size_t count, const TYPE values[], size_t n_values) { \
        (void)references, (void)values, (void)n_values;                                                                 \
        return no_such_type(c, count);                                                                                  \
    }

typedef const char *Text;
OTHER_TYPE(Float32, float)
OTHER_TYPE(Int8, int8_t)
OTHER_TYPE(UInt8, uint8_t)
OTHER_TYPE(Int16, int16_t)
OTHER_TYPE(UInt16, uint16_t)
OTHER_TYPE(Int32, int32_t)
OTHER_TYPE(UInt32, uint32_t)
OTHER_TYPE(Int64, int64_t)
OTHER_TYPE(UInt64, uint64_t)
OTHER_TYPE(Boolean, bool)
OTHER_TYPE(String, Text)

#define SOME void *c, const Reference references[], size_t count
#define UNUSED (void)references, (void)count

EXPORT Status fmi3GetBinary(SOME, size_t sizes[], const uint8_t *values[], size_t n_values) {
    (void)references, (void)sizes, (void)values, (void)n_values;
    return no_such_type(c, count);
}
EXPORT Status fmi3SetBinary(SOME, const size_t sizes[], const uint8_t *const values[], size_t n_values) {
    (void)references, (void)sizes, (void)values, (void)n_values;
    return no_such_type(c, count);
}
EXPORT Status fmi3GetClock(SOME, bool values[]) {
    (void)references, (void)values;
    return no_such_type(c, count);
}
EXPORT Status fmi3SetClock(SOME, const bool values[]) {
    (void)references, (void)values;
    return no_such_type(c, count);
}

EXPORT Status fmi3GetFMUState(void *c, void **state) { return status_of(keep_state(c, &((Instance *)c)->now, state)); }
EXPORT Status fmi3SetFMUState(void *c, void *state) { return status_of(take_state(c, state)); }

EXPORT Status fmi3FreeFMUState(void *c, void **state) {
    (void)c;
    drop_state(state);
    return OK;
}

EXPORT Status fmi3SerializedFMUStateSize(void *c, void *state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(Numbers);
    return OK;
}

EXPORT Status fmi3SerializeFMUState(void *c, void *state, uint8_t bytes[], size_t size) {
    return status_of(pack_state(c, state, bytes, size));
}

EXPORT Status fmi3DeserializeFMUState(void *c, const uint8_t bytes[], size_t size, void **state) {
    return status_of(unpack_state(c, bytes, size, state));
}

EXPORT Status fmi3EnterStepMode(void *c) { return not_offered(c); }

EXPORT Status fmi3DoStep(void *c, double time, double interval, bool is_final, bool *needs_events, bool *wants_to_end,
                         bool *returned_early, double *last_time) {
    (void)is_final;
    int is_done = step(c, time, interval);
    *needs_events = *wants_to_end = *returned_early = false;
    *last_time = ((Instance *)c)->now.variables[0];
    return status_of(is_done);
}

/* What a co-simulation without events, clocks and derivatives does not have. */
EXPORT Status fmi3EnterEventMode(void *c) { return not_offered(c); }
EXPORT Status fmi3EnterConfigurationMode(void *c) { return not_offered(c); }
EXPORT Status fmi3ExitConfigurationMode(void *c) { return not_offered(c); }
EXPORT Status fmi3EvaluateDiscreteStates(void *c) { return not_offered(c); }
EXPORT Status fmi3UpdateDiscreteStates(void *c, bool *more, bool *ends, bool *nominals, bool *values, bool *has_next, double *next) {
    (void)more, (void)ends, (void)nominals, (void)values, (void)has_next, (void)next;
    return not_offered(c);
}
EXPORT Status fmi3GetOutputDerivatives(SOME, const int32_t orders[], double values[], size_t n_values) {
    UNUSED, (void)orders, (void)values, (void)n_values;
    return not_offered(c);
}
EXPORT Status fmi3GetDirectionalDerivative(void *c, const Reference unknown[], size_t n_unknown, const Reference known[],
                                           size_t n_known, const double seed[], size_t n_seed, double out[], size_t n_out) {
    (void)unknown, (void)n_unknown, (void)known, (void)n_known, (void)seed, (void)n_seed, (void)out, (void)n_out;
    return not_offered(c);
}
EXPORT Status fmi3GetAdjointDerivative(void *c, const Reference unknown[], size_t n_unknown, const Reference known[],
                                       size_t n_known, const double seed[], size_t n_seed, double out[], size_t n_out) {
    (void)unknown, (void)n_unknown, (void)known, (void)n_known, (void)seed, (void)n_seed, (void)out, (void)n_out;
    return not_offered(c);
}
EXPORT Status fmi3GetNumberOfVariableDependencies(void *c, Reference reference, size_t *count) {
    (void)reference, (void)count;
    return not_offered(c);
}
EXPORT Status fmi3GetVariableDependencies(void *c, Reference dependent, size_t elements[], Reference independents[],
                                          size_t others[], int kinds[], size_t count) {
    (void)dependent, (void)elements, (void)independents, (void)others, (void)kinds, (void)count;
    return not_offered(c);
}
EXPORT Status fmi3GetIntervalDecimal(SOME, double intervals[], int qualifiers[]) {
    UNUSED, (void)intervals, (void)qualifiers;
    return not_offered(c);
}
EXPORT Status fmi3GetIntervalFraction(SOME, uint64_t counters[], uint64_t resolutions[], int qualifiers[]) {
    UNUSED, (void)counters, (void)resolutions, (void)qualifiers;
    return not_offered(c);
}
EXPORT Status fmi3GetShiftDecimal(SOME, double shifts[]) {
    UNUSED, (void)shifts;
    return not_offered(c);
}
EXPORT Status fmi3GetShiftFraction(SOME, uint64_t counters[], uint64_t resolutions[]) {
    UNUSED, (void)counters, (void)resolutions;
    return not_offered(c);
}
EXPORT Status fmi3SetIntervalDecimal(SOME, const double intervals[]) {
    UNUSED, (void)intervals;
    return not_offered(c);
}
EXPORT Status fmi3SetIntervalFraction(SOME, const uint64_t counters[], const uint64_t resolutions[]) {
    UNUSED, (void)counters, (void)resolutions;
    return not_offered(c);
}
EXPORT Status fmi3SetShiftDecimal(SOME, const double shifts[]) {
    UNUSED, (void)shifts;
    return not_offered(c);
}
EXPORT Status fmi3SetShiftFraction(SOME, const uint64_t counters[], const uint64_t resolutions[]) {
    UNUSED, (void)counters, (void)resolutions;
    return not_offered(c);
}

/* Of model exchange and scheduled execution: some tools do not load a library without them. */
EXPORT Status fmi3EnterContinuousTimeMode(void *c) { return not_offered(c); }
EXPORT Status fmi3CompletedIntegratorStep(void *c, bool is_final, bool *has_event, bool *wants_to_end) {
    (void)is_final, (void)has_event, (void)wants_to_end;
    return not_offered(c);
}
EXPORT Status fmi3SetTime(void *c, double time) {
    (void)time;
    return not_offered(c);
}
EXPORT Status fmi3SetContinuousStates(void *c, const double values[], size_t count) {
    (void)values, (void)count;
    return not_offered(c);
}
#define OF_STATES(NAME)                                               \
    EXPORT Status fmi3Get##NAME(void *c, double values[], size_t count) { \
        (void)values, (void)count;                                    \
        return not_offered(c);                                        \
    }
OF_STATES(ContinuousStateDerivatives)
OF_STATES(EventIndicators)
OF_STATES(ContinuousStates)
OF_STATES(NominalsOfContinuousStates)
EXPORT Status fmi3GetNumberOfEventIndicators(void *c, size_t *count) {
    (void)count;
    return not_offered(c);
}
EXPORT Status fmi3GetNumberOfContinuousStates(void *c, size_t *count) {
    (void)count;
    return not_offered(c);
}
EXPORT Status fmi3ActivateModelPartition(void *c, Reference clock, double time) {
    (void)clock, (void)time;
    return not_offered(c);
}
