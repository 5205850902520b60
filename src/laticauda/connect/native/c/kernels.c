/* The kernels of single runs as a library for laticauda itself (laticauda.models.planar.kernel_library). The kernels are
   functions as Numba compiles them, which take arrays as structures, one number after the other; here they get functions
   that take addresses. KERNELS, in kernels.h, names all of them: F(0) F(1) ... */

#include <cpuid.h>
#include <stdint.h>
#include <stdlib.h>

#include "kernels.h"

#define EXPORT __attribute__((visibility("default")))

/* A march of one chain of bodies, apart from its state and its log; the same fields are in `_MarchNumbers` of
   kernel_library.py. */
struct march {
    int64_t n, tail_link, has_extras;
    int64_t *first_strip, *first_plate, *law;
    int64_t n_first_strip, n_first_plate, n_law;
    int64_t implicit, steps, every;
    double dt;
    int64_t n_rows, n_samples, size;
};

/* Arrays of one and of three dimensions: who owns the memory, the number of items, the size of one, the items, the shape
   and the strides. */
#define ARRAY_1(type) void *, void *, int64_t, int64_t, type *, int64_t, int64_t
#define ARRAY_3(type) void *, void *, int64_t, int64_t, type *, int64_t, int64_t, int64_t, int64_t, int64_t, int64_t
#define AS_ARRAY_1(items, n) NULL, NULL, n, 8, items, n, 8
#define AS_ARRAY_3(items, l, m) NULL, NULL, (l) * (m), 8, items, l, m, 1, 8 * (m), 8, 8

#define F(k) \
    int32_t laticauda_kernel_##k(int64_t *, void **, ARRAY_1(double), int64_t, ARRAY_1(int64_t), ARRAY_1(int64_t), \
                                 ARRAY_1(int64_t), int64_t, uint8_t, uint8_t, int64_t, double, int64_t, ARRAY_3(double)); \
    EXPORT int64_t laticauda_run_##k(double *rows, const struct march *m, double *log) { \
        int64_t written; \
        void *error; \
        int32_t status = laticauda_kernel_##k( \
            &written, &error, AS_ARRAY_1(rows, m->n_rows), m->n, AS_ARRAY_1(m->first_strip, m->n_first_strip), \
            AS_ARRAY_1(m->first_plate, m->n_first_plate), AS_ARRAY_1(m->law, m->n_law), m->tail_link, \
            m->has_extras != 0, m->implicit != 0, m->steps, m->dt, m->every, \
            AS_ARRAY_3(log, m->n_samples, m->size)); \
        return status == 0 ? written : -1; \
    }
KERNELS

/* What the kernels need of Numba's runtime: memory of one small array per run. */
struct memory {
    size_t n_owners;
    void *destructor, *argument, *items;
    size_t size;
    void *allocator;
};

void *NRT_MemInfo_alloc_aligned(size_t size, unsigned alignment) {
    struct memory *memory = calloc(1, sizeof *memory + size + alignment);
    if (memory == NULL) abort();
    uintptr_t first = (uintptr_t)(memory + 1);
    memory->n_owners = 1;
    memory->size = size;
    memory->items = (void *)((first + alignment - 1) / alignment * alignment);
    return memory;
}

void NRT_MemInfo_call_dtor(struct memory *memory) { free(memory); }

void NRT_Free(void *memory) { free(memory); }

/* Whether this processor is of the family x86-64-v3, and the system keeps its wide registers. */
EXPORT int laticauda_fits_processor(void) {
    unsigned a, b, c, d, low, high;
    const unsigned first = bit_FMA | bit_SSE4_2 | bit_MOVBE | bit_POPCNT | bit_OSXSAVE | bit_AVX | bit_F16C;
    const unsigned seventh = bit_BMI | bit_AVX2 | bit_BMI2;
    if (!__get_cpuid(1, &a, &b, &c, &d) || (c & first) != first) return 0;
    if (!__get_cpuid_count(7, 0, &a, &b, &c, &d) || (b & seventh) != seventh) return 0;
    if (!__get_cpuid(0x80000001, &a, &b, &c, &d) || !(c & 1u << 5)) return 0; /* lzcnt */
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return (low & 6) == 6;
}
