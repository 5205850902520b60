/* Calls an FMU's library (FMI 2.0 or 3.0) in any order, with wrong references, numbers and states: LIBRARY TOKEN VERSION CALLS SEED. */
#include <dlfcn.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MANY 3
#define MOST 1000
typedef struct { void *logger, *allocate, *release, *finished, *environment; } Callbacks;
static void *library;
static int is_three;
static uint64_t chance;

static uint32_t draw(uint32_t n) {
    chance ^= chance << 13, chance ^= chance >> 7, chance ^= chance << 17;
    return (uint32_t)(chance >> 20) % n;
}

static double number(void) {
    const double odd[] = {0.0, -1.0, 1e308, -1e308, 1e-320, INFINITY, -INFINITY, NAN, 1e9, 0.01};
    return draw(3) == 0 ? odd[draw(10)] : 1e-3 * draw(2000) - 1.0;
}

static void *find(const char *two, const char *three) {
    void *found = dlsym(library, is_three ? three : two);
    if (found == NULL) fprintf(stderr, "no %s\n", is_three ? three : two), exit(3);
    return found;
}

static void *fresh(const char *token) {
    static Callbacks callbacks;
    if (is_three) {
        void *(*begin)(const char *, const char *, const char *, bool, bool, bool, bool, const unsigned *, size_t, void *, void *, void *) =
            find("", "fmi3InstantiateCoSimulation");
        return begin("one", token, "", false, false, false, false, NULL, 0, NULL, NULL, NULL);
    }
    void *(*begin)(const char *, int, const char *, const char *, Callbacks *, int, int) = find("fmi2Instantiate", "");
    return begin("one", 1, token, "", &callbacks, 0, 0);
}

int main(int count, char **words) {
    if (count != 6) return 2;
    library = dlopen(words[1], RTLD_NOW);
    if (library == NULL) return fprintf(stderr, "%s\n", dlerror()), 3;
    is_three = words[3][0] == '3';
    chance = 88172645463325252u + 7919u * strtoull(words[5], NULL, 10);
    void (*drop)(void *) = find("fmi2FreeInstance", "fmi3FreeInstance");
    int (*leave)(void *) = find("fmi2ExitInitializationMode", "fmi3ExitInitializationMode");
    int (*stop)(void *) = find("fmi2Terminate", "fmi3Terminate");
    int (*reset)(void *) = find("fmi2Reset", "fmi3Reset");
    int (*keep)(void *, void **) = find("fmi2GetFMUstate", "fmi3GetFMUState");
    int (*take)(void *, void *) = find("fmi2SetFMUstate", "fmi3SetFMUState");
    int (*forget)(void *, void **) = find("fmi2FreeFMUstate", "fmi3FreeFMUState");
    int (*size_of)(void *, void *, size_t *) = find("fmi2SerializedFMUstateSize", "fmi3SerializedFMUStateSize");
    int (*pack)(void *, void *, char *, size_t) = find("fmi2SerializeFMUstate", "fmi3SerializeFMUState");
    int (*unpack)(void *, const char *, size_t, void **) = find("fmi2DeSerializeFMUstate", "fmi3DeserializeFMUState");
    void *get = find("fmi2GetReal", "fmi3GetFloat64"), *set = find("fmi2SetReal", "fmi3SetFloat64");
    void *enter = find("fmi2EnterInitializationMode", "fmi3EnterInitializationMode");
    void *step = find("fmi2DoStep", "fmi3DoStep");
    void *instances[MANY], *states[MANY] = {0};
    double now[MANY] = {0};
    long calls = 0, steps = 0, refused = 0, wrong = 0, most = strtol(words[4], NULL, 10);
    for (int i = 0; i < MANY; i++)
        if ((instances[i] = fresh(words[2])) == NULL) return fprintf(stderr, "no instance\n"), 4;
    while (calls < most) {
        int i = (int)draw(MANY), status = 0;
        void *one = instances[i];
        unsigned references[8];
        double values[8];
        size_t n = draw(9), size;
        for (size_t k = 0; k < 8; k++) {
            references[k] = draw(4) ? draw(60) : draw(2) ? draw(1000) : UINT32_MAX - draw(3);
            values[k] = number();
        }
        calls++;
        switch (draw(16)) {
        case 0: if (draw(20) == 0) { /* a state goes with its instance */
                if (states[i]) forget(one, &states[i]);
                drop(one);
                instances[i] = fresh(words[2]), now[i] = 0.0;
            } break;
        case 1: status = is_three ? ((int (*)(void *, bool, double, double, bool, double))enter)(one, draw(2), number(), draw(2) ? 0.0 : number(), 0, 0.0)
                                  : ((int (*)(void *))enter)(one); break;
        case 2: status = leave(one); break;
        case 3: if (draw(60) == 0) status = stop(one); break;
        case 4: if (draw(8) == 0) status = reset(one), now[i] = 0.0; break;
        case 5: case 6: case 7:
            status = is_three ? ((int (*)(void *, const unsigned *, size_t, double *, size_t))get)(one, references, n, values, draw(5) ? n : draw(9))
                              : ((int (*)(void *, const unsigned *, size_t, double *))get)(one, references, n, values); break;
        case 8: n = draw(3);
            status = is_three ? ((int (*)(void *, const unsigned *, size_t, const double *, size_t))set)(one, references, n, values, draw(5) ? n : draw(9))
                              : ((int (*)(void *, const unsigned *, size_t, const double *))set)(one, references, n, values); break;
        case 9: status = keep(one, &states[i]); break;
        case 10: if (states[i]) status = take(one, states[i]); break;
        case 11: if (states[i]) status = forget(one, &states[i]); break;
        case 12: if (states[i] && size_of(one, states[i], &size) == 0) {
                char *bytes = malloc(size);
                void *other = NULL;
                if (pack(one, states[i], bytes, size) == 0) {
                    for (uint32_t k = draw(4); k > 0; k--) bytes[draw((uint32_t)size)] ^= (char)(1u << draw(8));
                    status = unpack(one, bytes, draw(4) ? size : draw((uint32_t)size), &other);
                    if (status == 0) take(one, other);
                    if (other) forget(one, &other);
                }
                free(bytes);
            } break;
        default: {
            double interval = draw(8) ? 0.01 : number(), at = draw(12) ? now[i] : number(), last = 0.0;
            bool yes[3];
            if (interval > 1.0) interval = -interval; /* long steps take their time, and are no other */
            status = is_three ? ((int (*)(void *, double, double, bool, bool *, bool *, bool *, double *))step)(one, at, interval, 1, yes, yes + 1, yes + 2, &last)
                              : ((int (*)(void *, double, double, int))step)(one, at, interval, 1);
            if (status == 0) steps++, now[i] = at + interval;
        }
        }
        refused += status != 0;
        wrong += status < 0 || status > 5;
    }
    for (int i = 0; i < MANY; i++) {
        if (states[i]) forget(instances[i], &states[i]);
        drop(instances[i]);
    }
    printf("%ld calls, %ld steps, %ld refused, %ld unknown answers\n", calls, steps, refused, wrong);
    return wrong != 0;
}
