/* Servers of the C interface: their life, nodes and variables. See busbar/busbar.h for what holds
 * for all functions. */
#ifndef BUSBAR_C_SERVER_H
#define BUSBAR_C_SERVER_H

#include <busbar/c/application.h>
#include <busbar/c/value.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct busbar_server busbar_server;

/* One way to connect (Part 4, 7.14). */
typedef struct busbar_endpoint {
    const char* policy; /* "None", "Basic256Sha256", "Aes128_Sha256_RsaOaep", ... */
    int mode;
    bool allows_anonymous;
    bool allows_user_name;
} busbar_endpoint;

/* A user with a password. */
typedef struct busbar_user {
    const char* name;
    const char* password_hash; /* of busbar_hash_password, or of `busbar-controller` */
    bool is_read_only;         /* neither writes nor calls Methods */
} busbar_user;

/* Decides on a login that none of the users matches: BUSBAR_GOOD, or Bad_UserAccessDenied, which
 * should take as long for an unknown user as for a wrong password. `password` is not to be kept. */
typedef busbar_status (*busbar_login_callback)(void* context, busbar_text user,
                                               busbar_text password);

enum {
    BUSBAR_LIMITS_LARGE = 0, /* 120 connections, 100 sessions */
    BUSBAR_LIMITS_SMALL = 1  /* a handful of clients with a thousand items; below 16 MiB */
};

/* Describes a server. */
typedef struct busbar_server_config {
    size_t size;
    busbar_application application;
    const char* product_uri; /* "urn:busbar" if null */
    const char* manufacturer_name;
    const char* software_version;
    const char* address;  /* that it listens on; every one of the machine if null */
    uint16_t port;        /* 0: 4840 */
    bool takes_free_port; /* any free port instead; see busbar_server_port */
    /* Null: Basic256Sha256 with Sign and with SignAndEncrypt, user names only. */
    const busbar_endpoint* endpoints;
    size_t endpoint_count;
    const busbar_user* users;
    size_t user_count;
    busbar_login_callback login; /* null: none */
    void* login_context;
    bool anonymous_may_write; /* else anonymous users read only */
    int limits;               /* BUSBAR_LIMITS_... */
    /* Bytes that peers can make the server hold at most, if not 0: `limits` is ignored then.
     * At least busbar_memory_needed(BUSBAR_LIMITS_SMALL), else Bad_ConfigurationError. */
    uint64_t memory_limit;
    uint32_t shutdown_delay_ms; /* for which clients see State Shutdown; 0: none */
} busbar_server_config;

/* Sets the defaults; shutdown_delay_ms is 2,000. Does nothing for null. Any thread. */
BUSBAR_C_API void busbar_server_config_init(busbar_server_config* config);

/* The bytes that peers can make a server with these limits hold at most, without its own nodes and
 * values; 0 for an unknown preset. Any thread. */
BUSBAR_C_API uint64_t busbar_memory_needed(int limits);

/* Creates a server and takes its port, at which it listens after busbar_server_start. Stores a
 * handle in `server` also when it fails, for busbar_server_last_error and busbar_server_destroy;
 * all other functions then return the same failure. It is null only after Bad_OutOfMemory and
 * Bad_InvalidArgument. Bad_ConfigurationError for what cannot be; Bad_CommunicationError for a port
 * that cannot be had; and what Part 6, 6.2 has for certificates. */
BUSBAR_C_API busbar_status busbar_server_create(const busbar_server_config* config,
                                                busbar_server** server);

/* Closes all connections at once and frees the server with all that it owns: images and structures
 * too. Null is allowed. Threads that use what it owns must have ended. */
BUSBAR_C_API void busbar_server_destroy(busbar_server* server);

/* Returns why the last function that failed with this handle did; "" if none did. Terminated, at
 * most 255 bytes, valid until the next call with the handle. */
BUSBAR_C_API const char* busbar_server_last_error(const busbar_server* server);

/* Listens. Bad_CommunicationError if another program was faster, Bad_InvalidState if it listens. */
BUSBAR_C_API busbar_status busbar_server_start(busbar_server* server);

/* The port of the server; 0 for null, and if it has none. */
BUSBAR_C_API uint16_t busbar_server_port(const busbar_server* server);

/* Serves for `timeout_ms`, also if there is nothing to do; with 0 does what is due. Bad_Shutdown
 * once the server has stopped, Bad_InvalidState before it was started and within a callback. If the
 * first call finds no memory, it is Bad_OutOfMemory, and the server has stopped. */
BUSBAR_C_API busbar_status busbar_server_poll(busbar_server* server, uint32_t timeout_ms);

/* Serves until busbar_server_stop; if `ends_on_signals`, also until SIGINT or SIGTERM, which stay
 * caught until busbar_server_destroy. Returns BUSBAR_GOOD then, and at once for a server that has
 * stopped; Bad_InvalidState within a callback. Starts the server if it was not. */
BUSBAR_C_API busbar_status busbar_server_run(busbar_server* server, bool ends_on_signals);

/* Begins the shutdown (Part 5, 12.6): poll and run end after shutdown_delay_ms, or earlier if no
 * client is connected. Any thread. */
BUSBAR_C_API busbar_status busbar_server_stop(busbar_server* server);

/* Counts what a server has at present. */
typedef struct busbar_server_counts {
    size_t size; /* sizeof(busbar_server_counts), set by the caller */
    uint64_t connections;
    uint64_t sessions;
    uint64_t subscriptions;
    uint64_t monitored_items;
} busbar_server_counts;

BUSBAR_C_API busbar_status busbar_server_count(const busbar_server* server,
                                               busbar_server_counts* counts);

/* ---- Servers: nodes ------------------------------------------------------------------------ */

/* NodeIds are texts: "i=85", "ns=1;s=Speed". Nodes may be added and removed at any time, but not in
 * a callback, where these functions return Bad_InvalidState. Other errors are those of AddNodes
 * (Part 4, 5.8.2): Bad_NodeIdExists, Bad_NodeIdInvalid, Bad_ParentNodeIdInvalid,
 * Bad_BrowseNameInvalid, Bad_BrowseNameDuplicated, Bad_TypeDefinitionInvalid,
 * Bad_NodeAttributesInvalid. */

/* Has the attributes of every new node (Part 3, 5.2). */
typedef struct busbar_node {
    /* Null: the name, after that of the parent and '/' if that is a text of the same namespace. */
    const char* id;
    const char* parent; /* null: the Objects folder */
    const char* name;   /* required; its BrowseName, and its DisplayName unless there is one */
    uint16_t namespace_index;
    const char* display_name;
    const char* description;
} busbar_node;

/* Stores the index of a namespace, which is added if it is new. 1 is the application's. */
BUSBAR_C_API busbar_status busbar_server_add_namespace(busbar_server* server, const char* uri,
                                                       uint16_t* index);

/* Adds an Object (Part 3, 5.5.1); `type` is that of its type definition, FolderType if null. */
BUSBAR_C_API busbar_status busbar_server_add_object(busbar_server* server, const busbar_node* node,
                                                    const char* type);

/* Adds an ObjectType below `node->parent`, its supertype, which may be an event type
 * (Part 3, 5.5.2; Part 5, 6.4). Its `property_count` Properties have a value each, of which only
 * the type matters, and are the fields of an event. Types are not removed: after Bad_OutOfMemory
 * this one may be there, with some of its Properties or all. */
typedef struct busbar_property {
    const char* name;
    uint8_t type;
    bool is_array;
} busbar_property;

BUSBAR_C_API busbar_status busbar_server_add_object_type(busbar_server* server,
                                                         const busbar_node* node,
                                                         const busbar_property* properties,
                                                         size_t property_count);

/* Adds a reference in both directions (Part 4, 5.8.3). */
BUSBAR_C_API busbar_status busbar_server_add_reference(busbar_server* server, const char* source,
                                                       const char* type, const char* target);

/* Removes a node, and those below it. What variables and Methods among them kept is freed, and the
 * handles of the variables are not used again. Types cannot be removed; they, NodeSets, sources,
 * structures and images stay until busbar_server_destroy. */
BUSBAR_C_API busbar_status busbar_server_remove_node(busbar_server* server, const char* id);

/* Adds the nodes of a NodeSet2 file (Part 6, Annex F) that is in memory, as linked constant data:
 * all or none. `name` is for messages, of which busbar_server_last_error has the first.
 * Bad_ServiceUnsupported in a build without pugixml. */
BUSBAR_C_API busbar_status busbar_server_add_nodeset(busbar_server* server, const char* name,
                                                     const char* xml, size_t size);

/* Gives the value of one variable, of the variable's type. Begins as a null value, and is copied as
 * soon as the callback has returned. A bad status is that of the value; a time of 0 is now. */
typedef busbar_status (*busbar_read_callback)(void* context, const char* node,
                                              busbar_data_value* value);
/* Takes the value that a client writes, which has the variable's type; it may refuse it. */
typedef busbar_status (*busbar_write_callback)(void* context, const char* node,
                                               const busbar_data_value* value);

/* A Variable (Part 3, 5.6.2). It has its value in the server's memory, or of callbacks, or of a
 * source. */
typedef struct busbar_variable {
    size_t size;
    busbar_node node;
    /* Gives the DataType, ValueRank and ArrayDimensions, and the value unless there is a callback
     * or a source. An array may become shorter, not longer, unless it is empty. */
    busbar_value value;
    const char* data_type; /* instead of the value's, such as that of an enumeration; may be null */
    bool is_writable;
    bool is_property;
    /* Both may be null: then reads give the value that is kept, and writes keep theirs. With `read`
     * and without `write` nothing can be written. */
    busbar_read_callback read;
    busbar_write_callback write;
    void* context;
    /* Of busbar_server_add_source, which gets `handle`; 0: none. */
    uint32_t source;
    uint64_t handle;
} busbar_variable;

/* Sets everything to zero, and `size`. Does nothing for null. Any thread. */
BUSBAR_C_API void busbar_variable_init(busbar_variable* variable);

/* Adds a variable. Stores its handle, for busbar_server_set_value, in `handle`, which may be null;
 * 0 if it has callbacks or a source. */
BUSBAR_C_API busbar_status busbar_server_add_variable(busbar_server* server,
                                                      const busbar_variable* variable,
                                                      uint64_t* handle);

/* Gives a variable that exists, such as one of a NodeSet, the callbacks or the source of
 * `variable`, of which `node.id` names it and the rest of `node` is ignored. With neither, the
 * value that it has is kept in memory, unless there is one here. `handle` as above. */
BUSBAR_C_API busbar_status busbar_server_bind_variable(busbar_server* server,
                                                       const busbar_variable* variable,
                                                       uint64_t* handle);

/* Changes a value in memory, with the time of now if `time` is 0; with a bad status too the value
 * is one of the variable's type. Bad_NotFound for a handle that no variable has, such as that of
 * one that was removed or bound again, Bad_TypeMismatch for another type, Bad_InvalidArgument. */
BUSBAR_C_API busbar_status busbar_server_set_value(busbar_server* server, uint64_t handle,
                                                   const busbar_value* value, busbar_status status,
                                                   busbar_time time);

/* Stores the value in memory, as clients wrote it too. What it points at is valid until the
 * variable changes, or the next call of this function. Errors as above. */
BUSBAR_C_API busbar_status busbar_server_get_value(busbar_server* server, uint64_t handle,
                                                   busbar_data_value* value);

#ifdef __cplusplus
}
#endif

#endif
