/* Loads the library of an FMU (FMI 2.0), lets it swim, and prints all its variables after every 0.05 s: LIBRARY GUID COUNT STEPS. */
#include <stdio.h>
#include <stdlib.h>
#ifdef _WIN32
#include <windows.h>
#define OPEN(file) ((void *)LoadLibraryA(file))
#define FIND(library, name) ((void *)GetProcAddress((HMODULE)library, name))
#else
#include <dlfcn.h>
#define OPEN(file) dlopen(file, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif

typedef struct { void *logger, *allocate, *release, *finished, *environment; } Callbacks;

int main(int count, char **words) {
    if (count != 5) return 2;
    void *library = OPEN(words[1]);
    if (library == NULL) return 3;
    void *(*instantiate)(const char *, int, const char *, const char *, Callbacks *, int, int) = FIND(library, "fmi2Instantiate");
    int (*setup)(void *, int, double, double, int, double) = FIND(library, "fmi2SetupExperiment");
    int (*enter)(void *) = FIND(library, "fmi2EnterInitializationMode");
    int (*leave)(void *) = FIND(library, "fmi2ExitInitializationMode");
    int (*step)(void *, double, double, int) = FIND(library, "fmi2DoStep");
    int (*get)(void *, const unsigned int *, size_t, double *) = FIND(library, "fmi2GetReal");
    Callbacks callbacks = {0};
    unsigned int n = (unsigned int)atoi(words[3]);
    void *one = instantiate("one", 1, words[2], "", &callbacks, 0, 0);
    if (one == NULL || setup(one, 0, 0.0, 0.0, 0, 0.0) || enter(one) || leave(one)) return 4;
    for (int k = 0; k <= atoi(words[4]); k++) {
        if (k > 0 && step(one, 0.05 * (k - 1), 0.05, 0)) return 5;
        for (unsigned int i = 0; i < n; i++) {
            double value;
            if (get(one, &i, 1, &value)) return 6;
            printf("%.17g ", value);
        }
        printf("\n");
    }
    return 0;
}
