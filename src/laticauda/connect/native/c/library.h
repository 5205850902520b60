/* $words

   Written by laticauda $version. The kernels in the library: MIT license, copyright (c) The laticauda developers.

   Link with the C library and its mathematics (-lm). Nothing is allocated, and nothing belongs to the whole process:
   any number of robots can swim side by side, one thread each. A copy of the structure is a state to go back to.

       $name robot;
       ${name}_reset(&robot);
       robot.dt = 0.01;
       if (${name}_begin(&robot) != 0) return 1;
       while (robot.time < 30.0)
           if (${name}_step(&robot, 0.05) != 0) return 1;

   Units are SI's. Joints and links are counted from 0 at the tail; angles are counter-clockwise, seen from above. */

#ifndef ${guard}_H
#define ${guard}_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
$fields
    double rows[$rows]; /* of the kernels */
} $name;

/* What the functions return: 0 if all is well, else one of these, or the place of a variable that is no number in its
   range. Nothing has changed then. */
enum { ${guard}_DIVERGED = -1, ${guard}_WRONG_INTERVAL = -2 };

/* All variables as they were when this was written. */
void ${name}_reset($name *_robot);

/* Computes the start, at time 0, from the parameters and inputs. Of the parameters, dt alone means anything after it. */
int ${name}_begin($name *_robot);

/* Goes on by that many seconds, with the inputs as they are; sets the outputs. It is cut into equal steps of the
   integration, none longer than dt. */
int ${name}_step($name *_robot, double interval);

/* The name of the variable at a place, which is what the functions above return. */
const char *${name}_name(int place);

#ifdef __cplusplus
}
#endif

#endif
