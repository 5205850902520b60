/* One robot in water and what may be done with it, whatever the version of FMI.

   Book-keeping only: where numbers are kept, who may change them and when. All that computes is laticauda_move, which is
   compiled from laticauda's own kernels. Nothing here belongs to the whole process, so any number of instances can live
   side by side. "tables.h" is written for each robot: N_VARIABLES, N_NUMBERS, the arrays below, MODEL and DIGEST. */

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tables.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
#define MOST_STEPS 1e9 /* of one communication step: minutes */
#define MOST_TEXT 400  /* of a message */

extern int64_t laticauda_move(const int64_t *whole, const double *real, double *variables, double *rows, double interval);

#include "works.h"

typedef enum { BEFORE, BEGINNING, STEPPING, OVER, FAILED } Phase;

/* All that a run needs to go on, and nothing that is an address: a state is a copy of it. */
typedef struct {
    uint64_t model;
    int64_t phase;
    int64_t is_stale; /* variables changed, and the start was not computed anew yet */
    double start_time;
    double variables[N_VARIABLES];
    double rows[N_NUMBERS];
} Numbers;

typedef struct Instance {
    Numbers now;
    char *name;
    void *environment; /* of whoever holds this instance */
    void *logger;
    void (*release)(void *);
} Instance;

/* Each version of FMI has its own logger, and defines TOKEN, its word for MODEL. */
static void say(const Instance *instance, const char *text);

static int complain(const Instance *instance, const char *format, ...) {
    char text[MOST_TEXT];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    say(instance, text);
    return 0;
}

static void reset(Instance *instance) {
    memset(&instance->now, 0, sizeof instance->now);
    instance->now.model = DIGEST;
    instance->now.phase = BEFORE;
    instance->now.is_stale = 1;
    memcpy(instance->now.variables, first_values, sizeof first_values);
}

/* A new instance like `told`, which says who holds it; NULL if there is no memory or the model is another one. */
static Instance *created(const Instance *told, const char *model, void *(*allocate)(size_t, size_t)) {
    if (strcmp(model, MODEL) != 0) {
        complain(told, "The FMU's %s must be %s, got %s.", TOKEN, MODEL, model);
        return NULL;
    }
    Instance *instance = allocate(1, sizeof *instance);
    char *copy = allocate(strlen(told->name) + 1, 1);
    if (instance == NULL || copy == NULL) {
        if (instance != NULL) told->release(instance);
        if (copy != NULL) told->release(copy);
        complain(told, "There is not enough memory.");
        return NULL;
    }
    *instance = *told;
    instance->name = strcpy(copy, told->name);
    reset(instance);
    return instance;
}

static void destroy(Instance *instance) {
    if (instance == NULL) return;
    instance->release(instance->name);
    instance->release(instance);
}

/* Let the kernels work; the numbers are as before if the motion diverges. */
static int move(Instance *instance, double interval) {
    Numbers before = instance->now;
    instance->now.variables[0] -= before.start_time;
    if (!move_robot(instance->now.variables, instance->now.rows, interval)) {
        instance->now = before;
        return 0;
    }
    instance->now.variables[0] += before.start_time;
    instance->now.is_stale = 0;
    return 1;
}

/* Where the robot is before the first step, with the variables as they are. */
static int begin(Instance *instance) {
    if (!instance->now.is_stale || move(instance, 0.0)) return 1;
    instance->now.phase = FAILED;
    return complain(instance, "The start is beyond all bounds with these parameters; nothing was computed.");
}

static int is_free(const Instance *instance, const char *what) {
    if (instance->now.phase != FAILED) return 1;
    return complain(instance, "%s is no longer possible: the motion diverged. Reset the instance first.", what);
}

static int look(Instance *instance, size_t reference, double *value) {
    if (reference >= N_VARIABLES) return complain(instance, "There is no variable with the value reference %zu.", reference);
    if (causality[reference] == 'o' && !begin(instance)) return 0;
    *value = instance->now.variables[reference];
    return 1;
}

static int put(Instance *instance, size_t reference, double value) {
    Numbers *now = &instance->now;
    if (reference >= N_VARIABLES) return complain(instance, "There is no variable with the value reference %zu.", reference);
    const char *name = names[reference];
    if (causality[reference] != 'i' && causality[reference] != 'p')
        return complain(instance, "`%s` must not be set: it is neither an input nor a parameter.", name);
    if (causality[reference] == 'p' && now->phase != BEFORE && now->phase != BEGINNING)
        return complain(instance, "`%s` must be set before the initialization ends: it is a parameter.", name);
    if (!isfinite(value)) return complain(instance, "`%s` must be a finite number, got %g.", name, value);
    if (value < least[reference])
        return complain(instance, "`%s` must be >= %g, got %g.", name, least[reference], value);
    if (value > most[reference])
        return complain(instance, "`%s` must be <= %g, got %g.", name, most[reference], value);
    now->variables[reference] = value;
    if (now->phase == BEFORE || now->phase == BEGINNING) now->is_stale = 1;
    return 1;
}

static int step(Instance *instance, double time, double interval) {
    Numbers *now = &instance->now;
    if (!is_free(instance, "A step")) return 0;
    if (now->phase != STEPPING) return complain(instance, "A step must come after the initialization, and before the end.");
    if (!(interval > 0.0) || !isfinite(interval))
        return complain(instance, "The communication step must be > 0 s, got %g.", interval);
    if (interval / now->variables[DT] > MOST_STEPS)
        return complain(instance, "The communication step must be <= %g s, got %g.", MOST_STEPS * now->variables[DT], interval);
    double here = now->variables[0];
    if (!(fabs(time - here) <= 1e-9 * fabs(here) + 1e-6 * interval + 1e-9))
        return complain(instance, "The communication point must be t = %.9g s, where the last step ended, got %.9g.", here, time);
    if (move(instance, interval)) return 1;
    now->phase = FAILED;
    return complain(instance,
                    "The motion diverged between t = %.6g s and %.6g s (a position, angle, rate or torque went beyond all "
                    "bounds); try a smaller `dt`, smaller drag coefficients, or smaller inputs.",
                    here, here + interval);
}

static int enter(Instance *instance) {
    if (instance->now.phase != BEFORE) return complain(instance, "The initialization must come first.");
    instance->now.phase = BEGINNING;
    return 1;
}

static int leave(Instance *instance) {
    if (instance->now.phase != BEGINNING) return complain(instance, "There is no initialization to end.");
    if (!begin(instance)) return 0;
    instance->now.phase = STEPPING;
    return 1;
}

static int set_time(Instance *instance, double start) {
    if (instance->now.phase != BEFORE) return complain(instance, "The start time must be set before the initialization.");
    if (!isfinite(start)) return complain(instance, "The start time must be finite, got %g s.", start);
    instance->now.start_time = instance->now.variables[0] = start;
    instance->now.is_stale = 1;
    return 1;
}

static void terminate(Instance *instance) {
    if (instance->now.phase != FAILED) instance->now.phase = OVER;
}

/* A state is a copy of the numbers; its bytes are the numbers themselves. */
static int keep_state(const Instance *instance, const void *numbers, void **state) {
    if (*state == NULL) *state = malloc(sizeof(Numbers));
    if (*state == NULL) return complain(instance, "There is not enough memory for a state.");
    memcpy(*state, numbers, sizeof(Numbers));
    return 1;
}

static int take_state(Instance *instance, const Numbers *state) {
    if (state == NULL || state->model != DIGEST) return complain(instance, "The state must be one of this model.");
    instance->now = *state;
    return 1;
}

static int pack_state(const Instance *instance, const void *state, void *bytes, size_t size) {
    if (state == NULL || size < sizeof(Numbers))
        return complain(instance, "A state needs %zu bytes, got %zu.", sizeof(Numbers), size);
    memcpy(bytes, state, sizeof(Numbers));
    return 1;
}

static int unpack_state(const Instance *instance, const void *bytes, size_t size, void **state) {
    uint64_t model = 0;
    if (size == sizeof(Numbers)) memcpy(&model, bytes, sizeof model);
    if (model != DIGEST) return complain(instance, "The state must be one of this model.");
    return keep_state(instance, bytes, state);
}

static void drop_state(void **state) {
    free(*state);
    *state = NULL;
}
