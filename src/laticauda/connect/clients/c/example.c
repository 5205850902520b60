/* Mamba swims two seconds to the left:
 *
 *   cc -std=c99 -Wall -Wextra example.c laticauda_client.c -lm -o example
 *   ./example 127.0.0.1 5055
 */

#include <stdio.h>
#include <string.h>

#include "laticauda_client.h"

static int refused(const char *answer)
{
    const char *why = laticauda_error(answer);
    if (answer == NULL)
        fputs("The server has gone.\n", stderr);
    else if (why != NULL)
        fprintf(stderr, "%.*s\n", (int)strcspn(why, "\""), why);
    return answer == NULL || why != NULL;
}

int main(int count, char **words)
{
    laticauda_client robot;
    double place[2], joints[64], time = 0.0;
    int n_joints = 0, i;
    const char *answer, *token = count > 3 ? words[3] : "";

    if (laticauda_connect(&robot, count > 1 ? words[1] : "127.0.0.1", count > 2 ? words[2] : "5055") != 0) {
        fputs("No server listens there: start one with `laticauda serve`.\n", stderr);
        return 1;
    }
    answer = laticauda_ask(&robot, "{\"do\":\"reset\",\"robot\":\"mamba\",\"token\":\"%s\"}", token);
    for (i = 0; i < 40 && !refused(answer); i++)
        answer = laticauda_ask(&robot, "{\"do\":\"step\",\"duration\":%.17g,\"offset\":%.17g}", 0.05, 0.1);
    if (i == 40 && !refused(answer) && laticauda_number(answer, "time", &time) == 1 &&
        laticauda_numbers(answer, "center_of_mass", place, 2) == 2)
        n_joints = laticauda_numbers(answer, "joint_angle", joints, 64);
    if (n_joints > 0)
        printf("%.3f s: %.9f m, %.9f m, %d joints, the last at %.9f rad\n", time, place[0], place[1], n_joints,
               joints[n_joints - 1]);
    answer = laticauda_ask(&robot, "{\"do\":\"step\",\"duration\":-1}");
    refused(answer);
    laticauda_close(&robot);
    return n_joints > 0 ? 0 : 1;
}
