/* What a web page needs beside laticauda_move: places in the module's memory for tables, variables and rows. */

#include <stddef.h>
#include <stdint.h>

#define PAGE 65536

extern unsigned char __heap_base;

/* The address of so many bytes that nobody else has, aligned for any number; NULL if there is no memory. */
void *laticauda_reserve(size_t bytes) {
    static uintptr_t end = 0;
    uintptr_t here = ((end == 0 ? (uintptr_t)&__heap_base : end) + 15) & ~(uintptr_t)15;
    size_t pages = (here + bytes + PAGE - 1) / PAGE, now = __builtin_wasm_memory_size(0);
    if (pages > now && __builtin_wasm_memory_grow(0, pages - now) == SIZE_MAX) return NULL;
    end = here + bytes;
    return (void *)here;
}
