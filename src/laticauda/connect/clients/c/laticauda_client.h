/* A robot in water that `laticauda serve` swims, driven from C.
 *
 *   laticauda_client robot;
 *   double heading;
 *   if (laticauda_connect(&robot, "127.0.0.1", "5055") != 0) ...
 *   const char *answer = laticauda_ask(&robot, "{\"do\":\"step\",\"duration\":%.17g}", 0.05);
 *   if (laticauda_error(answer) == NULL && laticauda_number(answer, "heading", &heading) == 1) ...
 *   laticauda_close(&robot);
 *
 * Messages and units: docs/cosim-protocol.md; their JSON Schema: `laticauda serve --schema`. It needs POSIX sockets; on
 * Windows take winsock2.h for the headers of sockets, call WSAStartup first, recv and send for read and write, and
 * closesocket for close. Numbers are written and read in the locale "C", a program's own unless it calls setlocale.
 */

#ifndef LATICAUDA_CLIENT_H
#define LATICAUDA_CLIENT_H

#include <stddef.h>

typedef struct {
    int wire;       /* the socket, -1 if there is none */
    char *answer;   /* the last line that came, ended by 0 */
    size_t room;    /* bytes of it */
    size_t have;    /* bytes that came, more than the line if the server is ahead */
    size_t line;    /* length of the line with its end */
} laticauda_client;

/* Connect; 0, or -1 if nobody listens there. */
int laticauda_connect(laticauda_client *client, const char *host, const char *port);

/* Send a request, one line of JSON without its end, written as by printf; the answer, which stands until the next
 * request, or NULL if the connection has ended, or there is no memory. Texts of others in it are to be escaped. */
const char *laticauda_ask(laticauda_client *client, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 2, 3)))
#endif
    ;

/* Up to MOST numbers of the first field of this name, at whatever depth, in their order; how many there are, rows of
 * rows counted on, or -1 if there is no such field. Null counts as a number that is not one (NaN). */
int laticauda_numbers(const char *answer, const char *name, double *values, int most);

/* One number; 1, or something else if there is no such field, or it holds another count of numbers. */
int laticauda_number(const char *answer, const char *name, double *value);

/* Where the sentence begins with which the server refused, still escaped and up to the next quotation mark; NULL if it
 * did not refuse. */
const char *laticauda_error(const char *answer);

/* Leave; the server forgets the world. */
void laticauda_close(laticauda_client *client);

#endif
