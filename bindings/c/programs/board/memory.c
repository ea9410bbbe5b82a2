/*
 * Functions of the C library that the library calls, for a program without a C library: with -nostdlib, link this file.
 * Includes the names of the Arm run-time ABI.
 */
#include <stddef.h>
#include <stdint.h>

void *memcpy(void *restrict to, const void *restrict from, size_t bytes);
void *memmove(void *to, const void *from, size_t bytes);
void *memset(void *to, int value, size_t bytes);

/* Without this the compiler would turn the loops into calls of the same functions. */
#pragma GCC optimize("no-tree-loop-distribute-patterns")

void *memcpy(void *restrict to, const void *restrict from, size_t bytes) {
    unsigned char *out = to;
    const unsigned char *in = from;
    while (bytes-- > 0u) {
        *out++ = *in++;
    }
    return to;
}

void *memmove(void *to, const void *from, size_t bytes) {
    unsigned char *out = to;
    const unsigned char *in = from;
    size_t at;
    if ((uintptr_t)out <= (uintptr_t)in) {
        for (at = 0; at < bytes; at++) {
            out[at] = in[at];
        }
    } else {
        for (at = bytes; at > 0u; at--) {
            out[at - 1u] = in[at - 1u];
        }
    }
    return to;
}

void *memset(void *to, int value, size_t bytes) {
    unsigned char *out = to;
    while (bytes-- > 0u) {
        *out++ = (unsigned char)value;
    }
    return to;
}

#define COPY(name)                                                 \
    void name(void *to, const void *from, size_t bytes);           \
    void name(void *to, const void *from, size_t bytes) {          \
        memmove(to, from, bytes);                                  \
    }
#define CLEAR(name)                          \
    void name(void *to, size_t bytes);       \
    void name(void *to, size_t bytes) {      \
        memset(to, 0, bytes);                \
    }
/* Arm's order of arguments differs from that of memset. */
#define SET(name)                                      \
    void name(void *to, size_t bytes, int value);      \
    void name(void *to, size_t bytes, int value) {     \
        memset(to, value, bytes);                      \
    }

COPY(__aeabi_memcpy)
COPY(__aeabi_memcpy4)
COPY(__aeabi_memcpy8)
COPY(__aeabi_memmove)
COPY(__aeabi_memmove4)
COPY(__aeabi_memmove8)
CLEAR(__aeabi_memclr)
CLEAR(__aeabi_memclr4)
CLEAR(__aeabi_memclr8)
SET(__aeabi_memset)
SET(__aeabi_memset4)
SET(__aeabi_memset8)
