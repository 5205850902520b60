/* Works after a jump of references.

   The joints' torque jumps with their references and dies away within some milliseconds, while their rates rise from
   what they were. The power between has a peak that steps of dt may step over, though the motion after it is right. So
   the first steps after a jump are done twice more, on copies: as they are, and in small parts. Their works' difference
   is what the works lack. The motion is not touched. */

#define JUMP 0.02            /* of a reference, from which on works are corrected [rad] */
#define CORRECTED_STEPS 12   /* after a jump */
#define PARTS_OF_FIRST 20    /* of the first of them */
#define PARTS_OF_OTHERS 4

typedef struct {
    double variables[N_VARIABLES];
    double rows[N_NUMBERS];
} Run;

static int advance(Run *run, double interval, double dt) {
    run->variables[DT] = dt;
    return laticauda_move(whole, real, run->variables, run->rows, interval) == 1;
}

static int references_jump(const double *variables, const double *rows) {
    for (int i = 0; i < N_REFERENCES; i++)
        if (fabs(variables[references[i][0]] - rows[references[i][1]]) > JUMP) return 1;
    return 0;
}

/* What the works of an interval lack, which begins with a jump; 0 if that cannot be found. */
static int find_missing_works(const double *variables, const double *rows, double interval, double *missing) {
    double steps = ceil(interval / variables[DT] - 1e-9);
    if (steps < 1.0) steps = 1.0;
    double dt = interval / steps;
    double corrected = steps < CORRECTED_STEPS ? steps : CORRECTED_STEPS;
    Run coarse;
    memcpy(coarse.variables, variables, sizeof coarse.variables);
    memcpy(coarse.rows, rows, sizeof coarse.rows);
    Run fine = coarse;
    if (!advance(&coarse, corrected * dt, dt)) return 0;
    if (!advance(&fine, dt, dt / PARTS_OF_FIRST)) return 0;
    if (corrected > 1.0 && !advance(&fine, (corrected - 1.0) * dt, dt / PARTS_OF_OTHERS)) return 0;
    for (int k = 0; k < N_WORKS; k++) missing[k] = fine.rows[works[k][1]] - coarse.rows[works[k][1]];
    return 1;
}

/* laticauda_move, with works that are right after jumps, too. */
static int move_robot(double *variables, double *rows, double interval) {
    double missing[N_WORKS];
    int lacks = interval > 0.0 && references_jump(variables, rows) && find_missing_works(variables, rows, interval, missing);
    if (laticauda_move(whole, real, variables, rows, interval) != 1) return 0;
    for (int k = 0; lacks && k < N_WORKS; k++) {
        rows[works[k][1]] += missing[k];
        variables[works[k][0]] += missing[k];
    }
    return 1;
}
