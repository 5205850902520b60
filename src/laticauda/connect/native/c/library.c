/* A robot in water as a plain library. What it offers is declared in header.h, which is written for each robot and
   defines ROBOT, the name of its structure, and FUNCTION, which makes names of functions; its numbers are in tables.h.
   The structure is an array of numbers with names: the variables, and behind them the rows of the kernels.
   No name here may be that of somebody's robot, so some begin with a line. */

#include <string.h>

#include "header.h"
#include "tables.h"

#define MOST_STEPS 1e9 /* of one call: minutes */
#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

extern int64_t laticauda_move(const int64_t *whole, const double *real, double *variables, double *rows, double interval);

#include "works.h"

_Static_assert(sizeof(ROBOT) == (N_VARIABLES + N_NUMBERS) * sizeof(double), "the structure is not what the kernels know");

/* The place of the first number that is set from outside and is out of its range; 0, that of the time, if there is none. */
static int wrong(const double *variables) {
    for (int i = 1; i < N_VARIABLES; i++)
        if (causality[i] != 'o' && !(isfinite(variables[i]) && variables[i] >= least[i] && variables[i] <= most[i])) return i;
    return 0;
}

static int move_on(ROBOT *_robot, double interval) {
    ROBOT next = *_robot;
    double *numbers = (double *)&next;
    int place = wrong(numbers);
    if (place != 0) return place;
    if (!move_robot(numbers, numbers + N_VARIABLES, interval)) return DIVERGED;
    *_robot = next;
    return 0;
}

EXPORT void FUNCTION(reset)(ROBOT *_robot) {
    memset(_robot, 0, sizeof *_robot);
    memcpy(_robot, first_values, sizeof first_values);
}

EXPORT int FUNCTION(begin)(ROBOT *_robot) {
    _robot->time = 0.0;
    return move_on(_robot, 0.0);
}

EXPORT int FUNCTION(step)(ROBOT *_robot, double interval) {
    if (!(interval > 0.0 && interval / _robot->dt <= MOST_STEPS)) return WRONG_INTERVAL;
    return move_on(_robot, interval);
}

EXPORT const char *FUNCTION(name)(int place) {
    return place >= 0 && place < N_VARIABLES ? names[place] : "";
}
