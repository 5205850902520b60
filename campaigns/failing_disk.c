/* A disk that fails after some bytes: preloaded, see failing_disk.py.

   Bytes written to files below the folder DISK_FOLDER are counted. After DISK_BYTES of them every
   write, fsync and rename there fails with the error DISK_ERRNO; the write at the border is short,
   as on a full disk. */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static char folder[4096];
static long long bytes_left;
static int error_number; /* 0: the disk is well */

void set_disk(const char *path, long long bytes, int number)
{
    strncpy(folder, path, sizeof folder - 1);
    bytes_left = bytes;
    error_number = number;
}

__attribute__((constructor)) static void read_environment(void)
{
    const char *path = getenv("DISK_FOLDER");
    if (path != NULL)
        set_disk(path, atoll(getenv("DISK_BYTES")), atoi(getenv("DISK_ERRNO")));
}

static int is_below(const char *path)
{
    size_t length = strlen(folder);
    return strncmp(path, folder, length) == 0 && path[length] == '/';
}

static int is_on_disk(int file)
{
    char link[64], path[4096];
    ssize_t length;
    int before = errno;
    if (error_number == 0 || file < 3)
        return 0;
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    length = readlink(link, path, sizeof path - 1);
    errno = before;
    if (length < 0)
        return 0;
    path[length] = 0;
    return is_below(path);
}

/* How many of so many bytes can still be written; -1 and errno if none. */
static ssize_t room_for(int file, size_t count)
{
    if (!is_on_disk(file))
        return (ssize_t)count;
    if (bytes_left <= 0) {
        errno = error_number;
        return -1;
    }
    if ((long long)count > bytes_left)
        count = (size_t)bytes_left;
    bytes_left -= (long long)count;
    return (ssize_t)count;
}

static int has_failed(int is_there)
{
    if (error_number == 0 || !is_there || bytes_left > 0)
        return 0;
    errno = error_number;
    return 1;
}

#define NEXT(type, name) ((type)dlsym(RTLD_NEXT, name))

ssize_t write(int file, const void *data, size_t count)
{
    ssize_t room = count ? room_for(file, count) : 0;
    return room < 0 ? -1 : NEXT(ssize_t (*)(int, const void *, size_t), "write")(file, data, (size_t)room);
}

ssize_t pwrite64(int file, const void *data, size_t count, off64_t at)
{
    ssize_t room = count ? room_for(file, count) : 0;
    return room < 0 ? -1
                    : NEXT(ssize_t (*)(int, const void *, size_t, off64_t), "pwrite64")(file, data, (size_t)room, at);
}

ssize_t pwrite(int file, const void *data, size_t count, off_t at)
{
    return pwrite64(file, data, count, at);
}

ssize_t writev(int file, const struct iovec *parts, int count)
{
    if (!is_on_disk(file) || count < 1)
        return NEXT(ssize_t (*)(int, const struct iovec *, int), "writev")(file, parts, count);
    return write(file, parts[0].iov_base, parts[0].iov_len);
}

int fsync(int file)
{
    return has_failed(is_on_disk(file)) ? -1 : NEXT(int (*)(int), "fsync")(file);
}

int fdatasync(int file)
{
    return has_failed(is_on_disk(file)) ? -1 : NEXT(int (*)(int), "fdatasync")(file);
}

int rename(const char *from, const char *to)
{
    char path[4096];
    int is_there = 0;
    if (error_number != 0)
        is_there = realpath(from, path) != NULL && is_below(path);
    return has_failed(is_there) ? -1 : NEXT(int (*)(const char *, const char *), "rename")(from, to);
}
