/* The functions of FMI 2.0 for co-simulation, as the standard declares them; what they do is in instance.h. */

#define TOKEN "GUID"
#include "instance.h"

typedef unsigned int Reference;
typedef int Boolean;
typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;
typedef void (*Logger)(void *environment, const char *instance, Status status, const char *category, const char *message, ...);

typedef struct {
    Logger logger;
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *);
    void (*step_finished)(void *environment, Status status);
    void *environment;
} Callbacks;

/* A message is a format; some tools read no arguments of it, so the text itself is the format. */
static void say(const Instance *instance, const char *text) {
    char format[2 * MOST_TEXT];
    size_t end = 0;
    if (instance->logger == NULL) return;
    for (; *text != 0; text++) {
        if (*text == '%') format[end++] = '%';
        format[end++] = *text;
    }
    format[end] = 0;
    ((Logger)instance->logger)(instance->environment, instance->name, ERROR, "logStatusError", format);
}

static Status status_of(int is_done) { return is_done ? OK : ERROR; }

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

EXPORT Status fmi2SetDebugLogging(void *c, Boolean is_on, size_t count, const char *const categories[]) {
    (void)c, (void)is_on, (void)count, (void)categories; /* errors are told always, and there is nothing else to tell */
    return OK;
}

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const Callbacks *callbacks, Boolean is_visible, Boolean is_logging) {
    (void)resources, (void)is_visible, (void)is_logging;
    if (callbacks == NULL || name == NULL || guid == NULL) return NULL;
    int is_theirs = callbacks->allocate != NULL && callbacks->release != NULL;
    Instance told = {
        .logger = (void *)callbacks->logger,
        .environment = callbacks->environment,
        .name = (char *)name,
        .release = is_theirs ? callbacks->release : free,
    };
    if (type != 1) {
        complain(&told, "This FMU is for co-simulation only.");
        return NULL;
    }
    return created(&told, guid, is_theirs ? callbacks->allocate : calloc);
}

EXPORT void fmi2FreeInstance(void *c) { destroy(c); }

EXPORT Status fmi2SetupExperiment(void *c, Boolean has_tolerance, double tolerance, double start, Boolean has_stop, double stop) {
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    return status_of(set_time(c, start));
}

EXPORT Status fmi2EnterInitializationMode(void *c) { return status_of(enter(c)); }
EXPORT Status fmi2ExitInitializationMode(void *c) { return status_of(leave(c)); }

EXPORT Status fmi2Terminate(void *c) {
    terminate(c);
    return OK;
}

EXPORT Status fmi2Reset(void *c) {
    reset(c);
    return OK;
}

EXPORT Status fmi2GetReal(void *c, const Reference references[], size_t count, double values[]) {
    for (size_t i = 0; i < count; i++)
        if (!look(c, references[i], &values[i])) return ERROR;
    return OK;
}

EXPORT Status fmi2SetReal(void *c, const Reference references[], size_t count, const double values[]) {
    for (size_t i = 0; i < count; i++)
        if (!put(c, references[i], values[i])) return ERROR;
    return OK;
}

static Status no_such_type(void *c, size_t count) {
    return count == 0 ? OK : status_of(complain(c, "All variables of this FMU are of type Real."));
}

EXPORT Status fmi2GetInteger(void *c, const Reference references[], size_t count, int values[]) {
    (void)references, (void)values;
    return no_such_type(c, count);
}
EXPORT Status fmi2GetBoolean(void *c, const Reference references[], size_t count, Boolean values[]) {
    (void)references, (void)values;
    return no_such_type(c, count);
}
EXPORT Status fmi2GetString(void *c, const Reference references[], size_t count, const char *values[]) {
    (void)references, (void)values;
    return no_such_type(c, count);
}
EXPORT Status fmi2SetInteger(void *c, const Reference references[], size_t count, const int values[]) {
    (void)references, (void)values;
    return no_such_type(c, count);
}
EXPORT Status fmi2SetBoolean(void *c, const Reference references[], size_t count, const Boolean values[]) {
    (void)references, (void)values;
    return no_such_type(c, count);
}
EXPORT Status fmi2SetString(void *c, const Reference references[], size_t count, const char *const values[]) {
    (void)references, (void)values;
    return no_such_type(c, count);
}

EXPORT Status fmi2GetFMUstate(void *c, void **state) { return status_of(keep_state(c, &((Instance *)c)->now, state)); }
EXPORT Status fmi2SetFMUstate(void *c, void *state) { return status_of(take_state(c, state)); }

EXPORT Status fmi2FreeFMUstate(void *c, void **state) {
    (void)c;
    drop_state(state);
    return OK;
}

EXPORT Status fmi2SerializedFMUstateSize(void *c, void *state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(Numbers);
    return OK;
}

EXPORT Status fmi2SerializeFMUstate(void *c, void *state, char bytes[], size_t size) {
    return status_of(pack_state(c, state, bytes, size));
}

EXPORT Status fmi2DeSerializeFMUstate(void *c, const char bytes[], size_t size, void **state) {
    return status_of(unpack_state(c, bytes, size, state));
}

EXPORT Status fmi2DoStep(void *c, double time, double interval, Boolean is_final) {
    (void)is_final;
    return status_of(step(c, time, interval));
}

EXPORT Status fmi2CancelStep(void *c) { return status_of(complain(c, "There is no step to cancel: steps are done at once.")); }

static Status not_offered(void *c) { return status_of(complain(c, "The model description does not offer this.")); }

EXPORT Status fmi2SetRealInputDerivatives(void *c, const Reference references[], size_t count, const int order[], const double values[]) {
    (void)references, (void)count, (void)order, (void)values;
    return not_offered(c);
}
EXPORT Status fmi2GetRealOutputDerivatives(void *c, const Reference references[], size_t count, const int order[], double values[]) {
    (void)references, (void)count, (void)order, (void)values;
    return not_offered(c);
}
EXPORT Status fmi2GetDirectionalDerivative(void *c, const Reference unknown[], size_t n_unknown, const Reference known[],
                                           size_t n_known, const double seed[], double values[]) {
    (void)unknown, (void)n_unknown, (void)known, (void)n_known, (void)seed, (void)values;
    return not_offered(c);
}

/* Steps are done at once, so there is nothing to ask about one that is under way. */
EXPORT Status fmi2GetStatus(void *c, int kind, Status *value) {
    (void)c, (void)kind, (void)value;
    return DISCARD;
}
EXPORT Status fmi2GetRealStatus(void *c, int kind, double *value) {
    if (kind != 2) return DISCARD; /* the last time that was reached */
    *value = ((Instance *)c)->now.variables[0];
    return OK;
}
EXPORT Status fmi2GetIntegerStatus(void *c, int kind, int *value) {
    (void)c, (void)kind, (void)value;
    return DISCARD;
}
EXPORT Status fmi2GetBooleanStatus(void *c, int kind, Boolean *value) {
    (void)c;
    if (kind != 3) return DISCARD; /* whether it wants to end */
    *value = 0;
    return OK;
}
EXPORT Status fmi2GetStringStatus(void *c, int kind, const char **value) {
    (void)c, (void)kind, (void)value;
    return DISCARD;
}
