/* See laticauda_client.h. */

#define _POSIX_C_SOURCE 200809L

#include "laticauda_client.h"

#include <errno.h>
#include <math.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

int laticauda_connect(laticauda_client *client, const char *host, const char *port)
{
    struct addrinfo wanted = {0}, *found, *one;
    int on = 1;
    *client = (laticauda_client){.wire = -1};
    wanted.ai_socktype = SOCK_STREAM;
    if (getaddrinfo(host, port, &wanted, &found) != 0)
        return -1;
    for (one = found; one != NULL && client->wire < 0; one = one->ai_next) {
        int wire = socket(one->ai_family, one->ai_socktype, one->ai_protocol);
        if (wire < 0)
            continue;
        if (connect(wire, one->ai_addr, one->ai_addrlen) == 0)
            client->wire = wire;
        else
            close(wire);
    }
    freeaddrinfo(found);
    if (client->wire < 0)
        return -1;
    setsockopt(client->wire, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on); /* small messages leave at once */
    return 0;
}

static int send_all(int wire, const char *text, size_t length)
{
    while (length > 0) {
        ssize_t sent = send(wire, text, length, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0)
            return -1;
        text += sent;
        length -= (size_t)sent;
    }
    return 0;
}

static const char *next_line(laticauda_client *client)
{
    size_t looked = 0;
    client->have -= client->line; /* what came behind the last line */
    if (client->have > 0)
        memmove(client->answer, client->answer + client->line, client->have);
    client->line = 0;
    for (;;) {
        ssize_t came;
        char *end = client->have > looked ? memchr(client->answer + looked, '\n', client->have - looked) : NULL;
        if (end != NULL) {
            *end = '\0';
            client->line = (size_t)(end - client->answer) + 1;
            return client->answer;
        }
        looked = client->have;
        if (client->room - client->have < 4096) {
            size_t room = client->room > 0 ? 2 * client->room : 65536;
            char *larger = realloc(client->answer, room);
            if (larger == NULL)
                return NULL;
            client->answer = larger;
            client->room = room;
        }
        came = recv(client->wire, client->answer + client->have, client->room - client->have, 0);
        if (came < 0 && errno == EINTR)
            continue;
        if (came <= 0)
            return NULL;
        client->have += (size_t)came;
    }
}

const char *laticauda_ask(laticauda_client *client, const char *format, ...)
{
    va_list given;
    char *text;
    int length, failed;
    va_start(given, format);
    length = vsnprintf(NULL, 0, format, given);
    va_end(given);
    if (length < 0 || (text = malloc((size_t)length + 1)) == NULL)
        return NULL;
    va_start(given, format);
    vsnprintf(text, (size_t)length + 1, format, given);
    va_end(given);
    text[length] = '\n'; /* in the place of the 0 */
    failed = send_all(client->wire, text, (size_t)length + 1);
    free(text);
    return failed ? NULL : next_line(client);
}

/* Behind the text that begins at a quotation mark; NULL if it does not end. */
static const char *behind_text(const char *at)
{
    for (at++; *at != '\0' && *at != '"'; at++)
        if (*at == '\\' && at[1] != '\0')
            at++;
    return *at == '"' ? at + 1 : NULL;
}

static const char *skip_space(const char *at)
{
    return at + strspn(at, " \t\r\n");
}

/* Where the value of the first field of this name begins; NULL if there is none. */
static const char *field(const char *answer, const char *name)
{
    size_t length = strlen(name);
    const char *at = answer;
    while (at != NULL && *at != '\0') {
        const char *begin = at;
        if (*at != '"') {
            at++;
            continue;
        }
        at = behind_text(at);
        if (at == NULL)
            return NULL;
        if (*skip_space(at) != ':')
            continue; /* a value */
        if ((size_t)(at - begin) == length + 2 && memcmp(begin + 1, name, length) == 0)
            return skip_space(skip_space(at) + 1);
    }
    return NULL;
}

int laticauda_numbers(const char *answer, const char *name, double *values, int most)
{
    const char *at = answer == NULL ? NULL : field(answer, name);
    int count = 0, depth = 0;
    if (at == NULL)
        return -1;
    do {
        char *behind;
        double number;
        at = skip_space(at);
        if (*at == '[' || *at == ']') {
            depth += *at == '[' ? 1 : -1;
            at++;
        } else if (*at == ',') {
            at++;
        } else {
            if (strncmp(at, "null", 4) == 0) {
                number = NAN;
                behind = (char *)at + 4;
            } else {
                number = strtod(at, &behind);
            }
            if (behind == at)
                return -1; /* a text, or an object */
            if (count < most)
                values[count] = number;
            count++;
            at = behind;
        }
    } while (depth > 0);
    return count;
}

int laticauda_number(const char *answer, const char *name, double *value)
{
    return laticauda_numbers(answer, name, value, 1);
}

const char *laticauda_error(const char *answer)
{
    const char *at = answer == NULL ? NULL : field(answer, "error");
    return at != NULL && *at == '"' ? at + 1 : NULL;
}

void laticauda_close(laticauda_client *client)
{
    if (client->wire >= 0)
        close(client->wire);
    free(client->answer);
    *client = (laticauda_client){.wire = -1};
}
