/* Busbar from C: an OPC UA server and client behind opaque handles. C99, and C++.
 *
 * Link busbar::c (CMake) or busbar-c (pkg-config). Part and section are those of OPC 10000.
 *
 * Status. Functions return a StatusCode (Part 4, 7.39; busbar_status_name names it): BUSBAR_GOOD,
 * or why nothing was changed. A null pointer that is required, a structure with the wrong `size`, a
 * text or number out of range is Bad_InvalidArgument; a failed allocation Bad_OutOfMemory; no
 * exception leaves a function, what was not expected is Bad_InternalError. For people there is a
 * text as well, in the handle (busbar_server_last_error, busbar_client_last_error) and not in the
 * thread or the caller's buffer: it needs no memory of a thread, which some systems lack, no
 * argument in each call, and no memory where memory has run out.
 *
 * Threads. A server, a client, and all that was made of them belong to one thread at a time, except
 * for the functions that say "any thread". Different handles may be on different threads. Callbacks
 * are called on the thread that serves the handle, except for the log's: a server's in
 * busbar_server_poll and _run, a client's in each function that waits (client.h). They must not
 * block, nor add or remove nodes, nor poll, run or destroy the handle they are called for, nor
 * throw or longjmp.
 *
 * Ownership. What is passed in is copied, unless a comment says that it must stay. What is handed
 * out through a pointer belongs to the handle, and stays until the event that the comment names.
 *
 * Growth. Structures with a member `size` are filled by their ..._init function, which sets `size`
 * and the defaults, or have `size` set by the caller; later versions add members at the end, and
 * use `size` to know what a program that was compiled earlier has. Each is cleared before it is
 * filled: a member that is 0 or null has its default. The shared library's symbols have the version
 * BUSBAR_1; a function never changes its meaning within it.
 *
 * Memory. Everything below is C++ and takes its memory from operator new, and from OpenSSL's and
 * pugixml's allocators; see busbar_set_allocator. */
#ifndef BUSBAR_BUSBAR_H
#define BUSBAR_BUSBAR_H

/* Read in this order. */
#include <busbar/c/value.h>

#include <busbar/c/process.h>

#include <busbar/c/application.h>

#include <busbar/c/server.h>

#include <busbar/c/source.h>

#include <busbar/c/client.h>

#endif
