/* Clients of the C interface. See busbar/busbar.h for what holds for all functions. */
#ifndef BUSBAR_C_CLIENT_H
#define BUSBAR_C_CLIENT_H

#include <busbar/c/application.h>
#include <busbar/c/value.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A connection to one server, which comes back by itself when it is lost, Subscriptions included.
 * It is served while a function that waits runs: connect, disconnect, read, write, call, browse,
 * poll and run. Called in a callback, those return Bad_RequestInterrupted. */
typedef struct busbar_client busbar_client;

enum {
    BUSBAR_CLIENT_WAITING = 0, /* for the next attempt, or the first */
    BUSBAR_CLIENT_CONNECTING = 1,
    BUSBAR_CLIENT_DISCOVERING = 2,
    BUSBAR_CLIENT_OPENING = 3,
    BUSBAR_CLIENT_READY = 4,
    BUSBAR_CLIENT_CLOSING = 5,
    BUSBAR_CLIENT_CLOSED = 6 /* by disconnect, or for good */
};

/* Called for each change of state, with the failure that caused it, or BUSBAR_GOOD. */
typedef void (*busbar_state_callback)(void* context, int state, busbar_status why);

typedef struct busbar_client_config {
    size_t size;
    busbar_application application;
    const char* url;       /* "opc.tcp://host:port/path"; required */
    const char* policy;    /* null: the best that both sides have, none of the deprecated */
    int least_mode;        /* BUSBAR_MODE_...; NONE also allows no security at all */
    const char* user_name; /* null: anonymous */
    const char* password;
    busbar_state_callback state; /* null: none */
    void* state_context;
    uint32_t request_timeout_ms; /* 0: 10,000 */
    uint32_t session_timeout_ms; /* 0: 60,000 */
} busbar_client_config;

/* Sets the defaults; least_mode is SIGN_AND_ENCRYPT. Does nothing for null. Any thread. */
BUSBAR_C_API void busbar_client_config_init(busbar_client_config* config);

/* Creates a client, as busbar_server_create creates a server: after a failure the handle is for
 * busbar_client_last_error and busbar_client_destroy only. */
BUSBAR_C_API busbar_status busbar_client_create(const busbar_client_config* config,
                                                busbar_client** client);
/* Drops the connection at once and frees the client. Null is allowed. */
BUSBAR_C_API void busbar_client_destroy(busbar_client* client);
/* Returns the text of the last failure, as busbar_server_last_error does. */
BUSBAR_C_API const char* busbar_client_last_error(const busbar_client* client);

/* Waits for a session (Part 4, 5.7), at most `timeout_ms`: Bad_Timeout, Bad_RequestInterrupted, or
 * the first failure that another attempt cannot cure. It keeps trying in later calls that wait. */
BUSBAR_C_API busbar_status busbar_client_connect(busbar_client* client, uint32_t timeout_ms);
/* Closes session and channel; waits until that is sent, at most two seconds. After
 * Bad_RequestInterrupted a later function that waits goes on with it. */
BUSBAR_C_API busbar_status busbar_client_disconnect(busbar_client* client);
/* BUSBAR_CLIENT_...; CLOSED for null. */
BUSBAR_C_API int busbar_client_state(const busbar_client* client);
/* Serves the connection for `timeout_ms`: callbacks are called. Bad_RequestInterrupted. */
BUSBAR_C_API busbar_status busbar_client_poll(busbar_client* client, uint32_t timeout_ms);
/* Serves the connection until busbar_client_interrupt, and returns BUSBAR_GOOD. */
BUSBAR_C_API busbar_status busbar_client_run(busbar_client* client);
/* Ends the function that waits now, or the next one. Any thread, and handlers of signals. */
BUSBAR_C_API busbar_status busbar_client_interrupt(busbar_client* client);

/* Nodes are texts: a NodeId "ns=2;s=Pump", one with a namespace's URI "nsu=urn:x;s=Pump", or a path
 * "/Objects/2:Machine/2:Speed". What results point at is valid until the next of these four
 * functions with the same client.
 *
 * Reads and writes have a status for each result. A request that fails, as without a connection,
 * gives its status to each result, and the function returns BUSBAR_GOOD. It returns a bad status,
 * which each result has as well, only if it was interrupted, for an invalid argument and without
 * memory: Bad_RequestInterrupted, Bad_InvalidArgument, Bad_OutOfMemory. A write that was
 * interrupted may have reached the server. */

/* Reads values (Part 4, 5.11.2): `count` of 1 to 1,000,000 nodes into `results`. */
BUSBAR_C_API busbar_status busbar_client_read(busbar_client* client, const char* const* nodes,
                                              size_t count, busbar_data_value* results);
/* Writes values (Part 4, 5.11.4), without status and times, into `count` nodes. */
BUSBAR_C_API busbar_status busbar_client_write(busbar_client* client, const char* const* nodes,
                                               const busbar_value* values, size_t count,
                                               busbar_status* results);
/* Calls a Method (Part 4, 5.12.2) once, and returns its status. Stores where its outputs are and
 * how many in `outputs` and `output_count`, which may both be null. */
BUSBAR_C_API busbar_status busbar_client_call(busbar_client* client, const char* object,
                                              const char* method, const busbar_value* inputs,
                                              size_t input_count, const busbar_value** outputs,
                                              size_t* output_count);

/* A node below another one. */
typedef struct busbar_reference {
    const char* node;
    const char* reference_type;
    busbar_qualified_name browse_name;
    busbar_localized_text display_name;
    int32_t node_class; /* Part 3, 8.29: 1 Object, 2 Variable, 4 Method, 8 ObjectType, ... */
} busbar_reference;

/* Browses the hierarchical references of a node forward (Part 4, 5.9.2), all of them. Stores where
 * they are and how many. Uncertain_NotAllNodesAvailable if there are too many. */
BUSBAR_C_API busbar_status busbar_client_browse(busbar_client* client, const char* node,
                                                const busbar_reference** references, size_t* count);

/* Gets a value of a monitored item, in a function that waits; valid during the call. */
typedef void (*busbar_data_callback)(void* context, uint32_t item, const busbar_data_value* value);

/* Creates a Subscription (Part 4, 5.14.2), and creates it again on each new session. Waits for
 * nothing: it comes to be in poll and run. Stores its number. Bad_TooManySubscriptions. */
BUSBAR_C_API busbar_status busbar_client_subscribe(busbar_client* client, double interval_ms,
                                                   busbar_data_callback callback, void* context,
                                                   uint32_t* subscription);
/* Monitors a node's value (Part 4, 5.13.2); a negative sampling interval is that of the
 * Subscription, a queue of 0 is one of 1. Stores the item's number, which the callback gets. A node
 * that cannot be monitored has its status as the item's value. Bad_SubscriptionIdInvalid. */
BUSBAR_C_API busbar_status busbar_client_monitor(busbar_client* client, uint32_t subscription,
                                                 const char* node, double sampling_ms,
                                                 uint32_t queue_size, uint32_t* item);
/* Removes a Subscription with its items, also in its callback, which is not called any more, so
 * that its context may be freed then. Bad_SubscriptionIdInvalid. */
BUSBAR_C_API busbar_status busbar_client_unsubscribe(busbar_client* client, uint32_t subscription);

#ifdef __cplusplus
}
#endif

#endif
