/* The process of the C interface: version, time, memory. See busbar/busbar.h for what holds for all
 * functions. */
#ifndef BUSBAR_C_PROCESS_H
#define BUSBAR_C_PROCESS_H

#include <busbar/c/value.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of the library, "0.1.0". Any thread. */
BUSBAR_C_API const char* busbar_version(void);

/* The specification's name of a status, "Bad_Timeout", without its lower 16 bits; "" for one that
 * has none. Constant. Any thread. */
BUSBAR_C_API const char* busbar_status_name(busbar_status status);

/* The time of the machine's clock. Any thread. */
BUSBAR_C_API busbar_time busbar_now(void);

/* The time of `seconds` since 1970-01-01T00:00:00Z and `nanoseconds` more. Any thread. */
BUSBAR_C_API busbar_time busbar_time_of_unix(int64_t seconds, int32_t nanoseconds);

/* Supplies memory. Both functions are called from any thread, and at the same time.
 * `allocate` returns `size` bytes, never 0, aligned to `alignment`, a power of two, or null if
 * there are none. `release` takes what `allocate` returned, never null. */
typedef struct busbar_allocator {
    size_t size;
    void* context;
    void* (*allocate)(void* context, size_t size, size_t alignment);
    void (*release)(void* context, void* memory);
} busbar_allocator;

/* Takes all memory of the process's C++ code, OpenSSL and pugixml from `allocator`. Call it before
 * all other functions and before anything else has used C++ or OpenSSL; once. Functions and
 * `context` must work to the very end: OpenSSL and C++ free memory after main has returned.
 *
 * Busbar takes its memory by operator new, which C++ lets a program replace, and nothing else can.
 * A program that links the static library has an operator new of Busbar's in place of the C++
 * library's, unless it has one of its own. It counts, and uses malloc until this call. So the
 * allocator gets what any C++ code of the process asks for. Not taken from it: what the C library
 * allocates itself (getaddrinfo, stdio, the stacks of threads), and the C++ library's exceptions,
 * which are thrown when memory runs out.
 *
 * Bad_InvalidState if memory of operator new or of OpenSSL is in use already, as in most programs
 * with C++ of their own; Bad_InvalidArgument. Bad_NotSupported if the program has an operator new
 * of its own, which then is what to change, and with the shared library, whose program has to have
 * its own in any case. */
BUSBAR_C_API busbar_status busbar_set_allocator(const busbar_allocator* allocator);

/* The memory that the process's C++ code uses. */
typedef struct busbar_memory {
    size_t size;            /* sizeof(busbar_memory), set by the caller */
    uint64_t blocks;        /* in use, of operator new */
    uint64_t bytes;         /* in them, as they were asked for */
    uint64_t largest_bytes; /* the most bytes that were in use at a time */
    uint64_t allocations;   /* since the process began */
    uint64_t failed;        /* allocations that failed */
} busbar_memory;

/* Stores the memory in use. Bad_NotSupported as above. Any thread. */
BUSBAR_C_API busbar_status busbar_memory_in_use(busbar_memory* memory);

/* Makes the hash of a password (scrypt, or PBKDF2 with `iterations` of 1,000 to 10,000,000 if that
 * is not 0) for busbar_user. Takes tens of milliseconds, scrypt 16.8 MB as well, and so does each
 * login. Stores it, terminated, in `hash`, of `size` bytes: 160 are enough, else Bad_OutOfRange.
 * Any thread. */
BUSBAR_C_API busbar_status busbar_hash_password(const char* password, uint32_t iterations,
                                                char* hash, size_t size);

#ifdef __cplusplus
}
#endif

#endif
