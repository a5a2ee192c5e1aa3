/* Busbar from C: an OPC UA server and client behind opaque handles. C99, and C++.
 *
 * Link busbar::c (CMake) or busbar-c (pkg-config). Part and section are those of OPC 10000.
 *
 * Status. Functions return a StatusCode (Part 4, 7.39; busbar_status_name names it): BUSBAR_GOOD, or
 * why nothing was changed. A null pointer that is required, a structure with the wrong `size`, a
 * text or number out of range is Bad_InvalidArgument; a failed allocation Bad_OutOfMemory; no
 * exception leaves a function, what was not expected is Bad_InternalError. For people there is a
 * text as well, in the handle (busbar_server_last_error, busbar_client_last_error) and not in the
 * thread or the caller's buffer: it needs no memory of a thread, which some systems lack, no
 * argument in each call, and no memory where memory has run out.
 *
 * Threads. A server, a client, and all that was made of them belong to one thread at a time, except
 * for the functions that say "any thread". Different handles may be on different threads. Callbacks
 * are called on the thread that is in busbar_..._poll or busbar_..._run, except for the log's. They
 * must not block, nor poll, run or destroy the handle they are called for, nor throw or longjmp.
 *
 * Ownership. What is passed in is copied, unless a comment says that it must stay. What is handed
 * out through a pointer belongs to the handle, and stays until the event that the comment names.
 *
 * Growth. Structures with a member `size` are filled by their ..._init function, which sets `size`
 * and the defaults, or have `size` set by the caller; later versions add members at the end, and use
 * `size` to know what a program that was compiled earlier has. Each is cleared before it is filled:
 * a member that is 0 or null has its default. The shared library's
 * symbols have the version BUSBAR_1; a function never changes its meaning within it.
 *
 * Memory. Everything below is C++ and takes its memory from operator new, and from OpenSSL's and
 * pugixml's allocators; see busbar_set_allocator. */
#ifndef BUSBAR_BUSBAR_H
#define BUSBAR_BUSBAR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define BUSBAR_C_API __attribute__((visibility("default")))
#else
#define BUSBAR_C_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Values ------------------------------------------------------------------------------- */

/* A StatusCode. The two uppermost bits say whether it is good (0), uncertain (1) or bad (2). */
typedef uint32_t busbar_status;

#define BUSBAR_GOOD 0x00000000U
/* What a callback returns that answers later. */
#define BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY 0x002E0000U
#define BUSBAR_BAD_INTERNAL_ERROR 0x80020000U
#define BUSBAR_BAD_OUT_OF_MEMORY 0x80030000U
#define BUSBAR_BAD_TIMEOUT 0x800A0000U
#define BUSBAR_BAD_SERVICE_UNSUPPORTED 0x800B0000U
#define BUSBAR_BAD_SHUTDOWN 0x800C0000U
#define BUSBAR_BAD_USER_ACCESS_DENIED 0x801F0000U
#define BUSBAR_BAD_NO_COMMUNICATION 0x80310000U
#define BUSBAR_BAD_NOT_WRITABLE 0x803B0000U
#define BUSBAR_BAD_OUT_OF_RANGE 0x803C0000U
#define BUSBAR_BAD_NOT_SUPPORTED 0x803D0000U
#define BUSBAR_BAD_NOT_FOUND 0x803E0000U
#define BUSBAR_BAD_TYPE_MISMATCH 0x80740000U
#define BUSBAR_BAD_INVALID_ARGUMENT 0x80AB0000U
#define BUSBAR_BAD_INVALID_STATE 0x80AF0000U

/* The built-in types by their ids (Part 6, 5.1.2) that a busbar_value can have. */
enum {
    BUSBAR_NULL = 0,
    BUSBAR_BOOLEAN = 1,
    BUSBAR_SBYTE = 2,
    BUSBAR_BYTE = 3,
    BUSBAR_INT16 = 4,
    BUSBAR_UINT16 = 5,
    BUSBAR_INT32 = 6,
    BUSBAR_UINT32 = 7,
    BUSBAR_INT64 = 8,
    BUSBAR_UINT64 = 9,
    BUSBAR_FLOAT = 10,
    BUSBAR_DOUBLE = 11,
    BUSBAR_STRING = 12,
    BUSBAR_DATE_TIME = 13,
    BUSBAR_GUID = 14,
    BUSBAR_BYTE_STRING = 15,
    BUSBAR_XML_ELEMENT = 16,
    BUSBAR_NODE_ID = 17,
    BUSBAR_EXPANDED_NODE_ID = 18,
    BUSBAR_STATUS_CODE = 19,
    BUSBAR_QUALIFIED_NAME = 20,
    BUSBAR_LOCALIZED_TEXT = 21,
    BUSBAR_EXTENSION_OBJECT = 22
};

/* 100 ns since 1601-01-01T00:00:00Z (Part 6, 5.2.2.5); 0 is "no time". */
typedef int64_t busbar_time;

/* Text in UTF-8, or bytes; not terminated. Null data is the null String, other than an empty one.
 * At most 2^31-1 bytes. */
typedef struct busbar_text {
    const char* data;
    size_t size;
} busbar_text;

/* Part 6, 5.2.2.6. */
typedef struct busbar_guid {
    uint32_t data1;
    uint16_t data2;
    uint16_t data3;
    uint8_t data4[8];
} busbar_guid;

/* Part 3, 8.3. */
typedef struct busbar_qualified_name {
    uint16_t namespace_index;
    busbar_text name;
} busbar_qualified_name;

/* Part 3, 8.5. */
typedef struct busbar_localized_text {
    busbar_text locale;
    busbar_text text;
} busbar_localized_text;

/* A structure as it is on the wire (Part 6, 5.2.2.15): the NodeId of its binary encoding, as text,
 * and its body. busbar_structure_pack and busbar_structure_unpack make it from a C struct. */
typedef struct busbar_extension {
    busbar_text encoding_id;
    busbar_text body;
} busbar_extension;

/* A value of a built-in type, an array or a matrix. Owns nothing: whoever fills it keeps what it
 * points at, as long as the function says that takes it.
 *
 * `as` has the member of the type. NodeIds and ExpandedNodeIds are texts (Part 6, 5.3.1.10):
 * "i=2258", "ns=2;s=Pump". For arrays `array` points at `count` elements of the member's type, in
 * row-major order for a matrix; it may be null if there are none. A matrix has two dimensions or
 * more, whose product is `count`; others have none. Variants, DataValues and DiagnosticInfos within
 * a value are Bad_NotSupported. */
typedef struct busbar_value {
    uint8_t type;
    bool is_array;
    uint8_t dimension_count;
    uint32_t count;
    const uint32_t* dimensions;
    union {
        bool boolean;
        int8_t sbyte;
        uint8_t byte;
        int16_t int16;
        uint16_t uint16;
        int32_t int32;
        uint32_t uint32;
        int64_t int64;
        uint64_t uint64;
        float float32;
        double float64;
        busbar_time time;
        busbar_guid guid;
        busbar_text text; /* String, ByteString, XmlElement, NodeId, ExpandedNodeId */
        busbar_status status;
        busbar_qualified_name qualified_name;
        busbar_localized_text localized_text;
        busbar_extension extension;
        const void* array;
    } as;
} busbar_value;

/* A value with its status and times (Part 4, 7.11). */
typedef struct busbar_data_value {
    busbar_value value;
    busbar_status status;
    busbar_time source_time;
    busbar_time server_time;
} busbar_data_value;

/* The number of bytes that a scalar of the type, or an element of an array, takes in a busbar_value;
 * 0 for a type that it cannot have. Any thread. */
BUSBAR_C_API size_t busbar_type_size(uint8_t type);

/* Make values of what most programs have. A null text is the null String. Any thread. */
BUSBAR_C_API busbar_value busbar_value_boolean(bool value);
BUSBAR_C_API busbar_value busbar_value_int32(int32_t value);
BUSBAR_C_API busbar_value busbar_value_uint32(uint32_t value);
BUSBAR_C_API busbar_value busbar_value_double(double value);
/* `text` is terminated, and must stay as long as the value is used. */
BUSBAR_C_API busbar_value busbar_value_string(const char* text);
/* `elements` must stay as long as the value is used, and has `count` elements of the type. */
BUSBAR_C_API busbar_value busbar_value_array(uint8_t type, const void* elements, uint32_t count);

/* ---- The process -------------------------------------------------------------------------- */

/* The version of the library, "0.1.0". Any thread. */
BUSBAR_C_API const char* busbar_version(void);

/* The specification's name of a status, "Bad_Timeout", without its lower 16 bits; "" for one that
 * has none. Constant. Any thread. */
BUSBAR_C_API const char* busbar_status_name(busbar_status status);

/* The time of the machine's clock. Any thread. */
BUSBAR_C_API busbar_time busbar_now(void);

/* The time of `seconds` since 1970-01-01T00:00:00Z and `nanoseconds` more. Any thread. */
BUSBAR_C_API busbar_time busbar_time_of_unix(int64_t seconds, int32_t nanoseconds);

/* Where memory comes from. Both are called from any thread, and at the same time.
 * `allocate` returns `size` bytes, never 0, aligned to `alignment`, a power of two, or null if there
 * are none. `release` takes what `allocate` returned, never null. */
typedef struct busbar_allocator {
    size_t size;
    void* context;
    void* (*allocate)(void* context, size_t size, size_t alignment);
    void (*release)(void* context, void* memory);
} busbar_allocator;

/* Takes all memory of the process's C++ code, OpenSSL and pugixml from `allocator`. Call it before
 * all other functions and before anything else has used C++ or OpenSSL; once.
 *
 * Busbar takes its memory by operator new. A program that refers to this function, or links the
 * shared library, has an operator new of Busbar's in place of the C++ library's, which uses malloc
 * until this call. So the allocator gets what any C++ code of the process asks for. Not taken from
 * it: what the C library allocates itself (getaddrinfo, stdio, the stacks of threads), and the
 * exceptions of the C++ library.
 *
 * Bad_InvalidState if memory of operator new or of OpenSSL is in use already, as in most programs
 * with C++ of their own; Bad_NotSupported if the program has an operator new of its own, which then
 * is what to change; Bad_InvalidArgument. */
BUSBAR_C_API busbar_status busbar_set_allocator(const busbar_allocator* allocator);

/* The memory that the process's C++ code uses. */
typedef struct busbar_memory {
    size_t size;              /* sizeof(busbar_memory), set by the caller */
    uint64_t blocks;          /* in use, of operator new */
    uint64_t bytes;           /* in them, as they were asked for */
    uint64_t largest_bytes;   /* the most bytes that were in use at a time */
    uint64_t allocations;     /* since the process began */
    uint64_t failed;          /* allocations that failed */
} busbar_memory;

/* Stores the memory in use. Bad_NotSupported if the program has an operator new of its own. Costs
 * nothing where it is not called; referring to it counts all allocations. Any thread. */
BUSBAR_C_API busbar_status busbar_memory_in_use(busbar_memory* memory);

/* Makes the hash of a password (scrypt, or PBKDF2 with `iterations` of 1,000 to 10,000,000 if that
 * is not 0) for busbar_user. Takes tens of milliseconds, scrypt 16.8 MB as well, and so does each
 * login. Stores it, terminated, in `hash`, of `size` bytes: 160 are enough, else Bad_OutOfRange.
 * Any thread. */
BUSBAR_C_API busbar_status busbar_hash_password(const char* password, uint32_t iterations,
                                                char* hash, size_t size);

/* ---- What servers and clients have in common ---------------------------------------------- */

enum { BUSBAR_LOG_DEBUG = 0, BUSBAR_LOG_INFO = 1, BUSBAR_LOG_WARNING = 2, BUSBAR_LOG_ERROR = 3 };

/* Gets the lines of a log, called from any thread. `source` is the part of the library; both texts
 * are printable, without secrets, terminated, and valid during the call. Must not call Busbar. */
typedef void (*busbar_log_callback)(void* context, int level, const char* source,
                                    const char* text);

/* An application's names, certificate and trust. With a folder, certificate, key and trust lists lie
 * there (Part 12, F.1); what is missing is created, which takes seconds for a key. Without a folder
 * they are memory, and the key is not written anywhere: for a machine without files. With neither,
 * only SecurityPolicy None works. */
typedef struct busbar_application {
    const char* uri;       /* globally unique; the certificate contains it. Required. */
    const char* name;      /* of the application; the uri if null */
    const char* host_name; /* in a new certificate and of the endpoint; "localhost" if null */
    const char* folder;
    /* DER or PEM, and the RSA key, PKCS#1 or PKCS#8. */
    const void* certificate;
    size_t certificate_size;
    const void* key;
    size_t key_size;
    /* `trusted_count` certificates or authorities, DER or PEM, that are trusted without a folder. */
    const busbar_text* trusted;
    size_t trusted_count;
    busbar_log_callback log; /* null: none */
    void* log_context;
    int log_level; /* the least level that is passed on */
} busbar_application;

/* MessageSecurityMode (Part 4, 7.20). */
enum { BUSBAR_MODE_NONE = 1, BUSBAR_MODE_SIGN = 2, BUSBAR_MODE_SIGN_AND_ENCRYPT = 3 };

/* ---- Servers: life ------------------------------------------------------------------------- */

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

/* What a server is made of. */
typedef struct busbar_server_config {
    size_t size;
    busbar_application application;
    const char* product_uri;      /* "urn:busbar" if null */
    const char* manufacturer_name;
    const char* software_version;
    const char* address; /* that it listens on; every one of the machine if null */
    uint16_t port;       /* 0: 4840 */
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
 * handle in `server` also when it fails, for busbar_server_last_error and busbar_server_destroy; all
 * other functions then return the same failure. It is null only after Bad_OutOfMemory and
 * Bad_InvalidArgument. Bad_ConfigurationError for what cannot be; Bad_CommunicationError for a port
 * that cannot be had; and what Part 6, 6.2 has for certificates. */
BUSBAR_C_API busbar_status busbar_server_create(const busbar_server_config* config,
                                                busbar_server** server);

/* Closes all connections at once and frees the server with all that it owns: images and structures
 * too. Null is allowed. Threads that use what it owns must have ended. */
BUSBAR_C_API void busbar_server_destroy(busbar_server* server);

/* Why the last function that failed with this handle did; "" if none did. Terminated, at most 255
 * bytes, valid until the next call with the handle. */
BUSBAR_C_API const char* busbar_server_last_error(const busbar_server* server);

/* Listens. Bad_CommunicationError if another program was faster, Bad_InvalidState if it listens. */
BUSBAR_C_API busbar_status busbar_server_start(busbar_server* server);

/* The port of the server; 0 for null, and if it has none. */
BUSBAR_C_API uint16_t busbar_server_port(const busbar_server* server);

/* Serves for `timeout_ms`, also if there is nothing to do; with 0 does what is due. Bad_Shutdown once
 * the server has stopped, Bad_InvalidState before it was started and within a callback. If the first
 * call finds no memory, it is Bad_OutOfMemory, and the server has stopped. */
BUSBAR_C_API busbar_status busbar_server_poll(busbar_server* server, uint32_t timeout_ms);

/* Serves until busbar_server_stop; if `ends_on_signals`, also until SIGINT or SIGTERM. Returns
 * BUSBAR_GOOD then, Bad_InvalidState within a callback. Starts the server if it was not. */
BUSBAR_C_API busbar_status busbar_server_run(busbar_server* server, bool ends_on_signals);

/* Begins the shutdown (Part 5, 12.6): poll and run end after shutdown_delay_ms, or earlier if no
 * client is connected. Any thread. */
BUSBAR_C_API busbar_status busbar_server_stop(busbar_server* server);

/* What a server has at present. */
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

/* NodeIds are texts: "i=85", "ns=1;s=Speed". Nodes may be added and removed at any time. Errors of
 * all functions here are those of AddNodes (Part 4, 5.8.2): Bad_NodeIdExists, Bad_NodeIdInvalid,
 * Bad_ParentNodeIdInvalid, Bad_BrowseNameInvalid, Bad_BrowseNameDuplicated,
 * Bad_TypeDefinitionInvalid, Bad_NodeAttributesInvalid. */

/* What every new node has (Part 3, 5.2). */
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
 * (Part 3, 5.5.2; Part 5, 6.4). Its `property_count` Properties have a value each, of which only the
 * type matters, and are the fields of an event. */
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

/* Removes a node, and those below it. */
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
    /* Gives the DataType, ValueRank and ArrayDimensions, and the value unless there is a callback or
     * a source. An array may become shorter, not longer, unless it is empty. */
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

/* Gives a variable that exists, such as one of a NodeSet, the callbacks or the source of `variable`,
 * of which `node.id` names it and the rest of `node` is ignored. With neither, the value that it has
 * is kept in memory, unless there is one here. `handle` as above. */
BUSBAR_C_API busbar_status busbar_server_bind_variable(busbar_server* server,
                                                       const busbar_variable* variable,
                                                       uint64_t* handle);

/* Changes a value in memory, with the time of now if `time` is 0. Bad_NotFound for a handle that no
 * variable has, Bad_TypeMismatch for another type, Bad_InvalidArgument. */
BUSBAR_C_API busbar_status busbar_server_set_value(busbar_server* server, uint64_t handle,
                                                   const busbar_value* value, busbar_status status,
                                                   busbar_time time);

/* Stores the value in memory, as clients wrote it too. What it points at is valid until the
 * variable changes, or the next call of this function. Errors as above. */
BUSBAR_C_API busbar_status busbar_server_get_value(busbar_server* server, uint64_t handle,
                                                   busbar_data_value* value);

/* ---- Servers: sources of many values ------------------------------------------------------- */

/* Reads or writes that wait for a source. */
typedef struct busbar_batch busbar_batch;

/* One value that is wanted; begins as Bad_NoCommunication. */
typedef struct busbar_read_item {
    uint64_t handle;
    busbar_data_value result;
} busbar_read_item;

/* One value to write, of the variable's type, and what came of it; begins as Bad_NoCommunication. */
typedef struct busbar_write_item {
    uint64_t handle;
    busbar_data_value value;
    busbar_status result;
} busbar_write_item;

/* A bus, a PLC: serves the variables that name it, those of one service call together (Part 4,
 * 5.11). A callback returns BUSBAR_GOOD when all items are done, a bad status for all of them, or
 * BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY and calls busbar_batch_complete later. The items are valid
 * until then; what results point at must stay until the batch is complete. */
typedef struct busbar_source {
    size_t size; /* sizeof(busbar_source), set by the caller */
    void* context;
    busbar_status (*read)(void* context, busbar_batch* batch, busbar_read_item* items,
                          size_t count);
    /* Null: nothing can be written. */
    busbar_status (*write)(void* context, busbar_batch* batch, busbar_write_item* items,
                           size_t count);
    uint32_t timeout_ms; /* after which items answer Bad_Timeout; 0: 5,000 */
    bool all_or_nothing; /* a Write is applied to all of its items or to none */
} busbar_source;

/* Adds a source, and stores its number, for busbar_variable. */
BUSBAR_C_API busbar_status busbar_server_add_source(busbar_server* server,
                                                    const busbar_source* source, uint32_t* number);

/* Ends a batch whose callback returned BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY, which must be done once
 * for each, even after its timeout and the end of the server. With a bad `status` all items have it.
 * Frees the batch with its items. Any thread, not within the callback. */
BUSBAR_C_API busbar_status busbar_batch_complete(busbar_batch* batch, busbar_status status);

/* ---- Servers: structures and process image ------------------------------------------------- */

/* A structure of the server: its DataType, and its form in memory. */
typedef struct busbar_structure busbar_structure;

/* A text in the memory of a structure or an image: its length, or 2^32-1 if it is null, and room for
 * `capacity` bytes, which are not terminated. Declares a member. */
#define BUSBAR_TEXT_MEMBER(name, capacity) \
    struct {                               \
        uint32_t size;                     \
        char data[capacity];               \
    } name

/* A member of a structure, or a variable of an image: Boolean to Double, String, DateTime, Guid,
 * ByteString, XmlElement, StatusCode, or an ExtensionObject with a `structure`. In memory they are
 * bool, int8_t to double, BUSBAR_TEXT_MEMBER, busbar_time, busbar_guid, busbar_status. */
typedef struct busbar_field {
    const char* name;
    uint8_t type;
    uint32_t count;    /* 0: a scalar; else an array of so many elements */
    uint32_t capacity; /* the bytes that a text may have */
    const busbar_structure* structure;
} busbar_field;

/* Adds a structure (Part 3, 8.48) as a DataType below Structure: `node->parent` is ignored. In
 * memory its members lie one after the other as a C compiler lays out a struct of the same members.
 * Stores a handle, which belongs to the server. */
BUSBAR_C_API busbar_status busbar_server_add_structure(busbar_server* server,
                                                       const busbar_node* node,
                                                       const busbar_field* fields, size_t count,
                                                       busbar_structure** structure);

/* The size of one in memory: that of the C struct, to compare with sizeof; 0 for null. */
BUSBAR_C_API size_t busbar_structure_size(const busbar_structure* structure);

/* Makes a value of a struct in memory. What it points at is valid until the next call with the same
 * structure. Bad_OutOfRange if `size` is not busbar_structure_size(). */
BUSBAR_C_API busbar_status busbar_structure_pack(busbar_structure* structure, const void* memory,
                                                 size_t size, busbar_value* value);

/* Stores a value in a struct. Bad_TypeMismatch for one of another structure, Bad_DecodingError,
 * Bad_OutOfRange for a text that is too long or a wrong `size`; nothing is changed then. */
BUSBAR_C_API busbar_status busbar_structure_unpack(busbar_structure* structure,
                                                   const busbar_value* value, void* memory,
                                                   size_t size);

/* The process image of a task: memory of the task's own whose variables a server publishes scan by
 * scan. All values of one Read are of one scan; a Write is applied as a whole at a scan's edge. */
typedef struct busbar_image busbar_image;

/* A variable, and where it lies in the memory, aligned as in a C struct. */
typedef struct busbar_image_variable {
    busbar_field field;
    size_t offset;
    bool is_writable;
} busbar_image_variable;

typedef struct busbar_image_config {
    size_t size; /* sizeof(busbar_image_config), set by the caller */
    void* memory; /* must stay while the server and the task use the image */
    size_t memory_size;
    const busbar_image_variable* variables;
    size_t count;
    const char* parent; /* of the variables; null: the Objects folder */
    uint16_t namespace_index;
    /* Time from scan to scan, 0 if unknown: items with this sampling interval or a shorter one see
     * every scan. */
    uint32_t cycle_us;
} busbar_image_config;

/* Adds an image with a Variable for each of its variables. Until the first scan they are
 * Bad_NoCommunication. Bad_OutOfRange for one outside of the memory, Bad_InvalidArgument for one
 * that is not aligned, Bad_DataTypeIdUnknown for another type. Adds all or none; the handle belongs
 * to the server. */
BUSBAR_C_API busbar_status busbar_server_add_image(busbar_server* server,
                                                   const busbar_image_config* config,
                                                   busbar_image** image);

/* The scan's edge: stores what clients wrote in the memory. These three are called on the task's
 * thread, which may be another one than the server's; they never wait, lock or allocate. */
BUSBAR_C_API void busbar_image_begin_scan(busbar_image* image);
/* Publishes the memory as it is; values that changed have this time. Then Writes are answered. */
BUSBAR_C_API void busbar_image_publish(busbar_image* image, busbar_time time);
/* The task stops: clients get the last values with Uncertain_LastUsableValue (Part 8, 7.3.2), until
 * the next scan. */
BUSBAR_C_API void busbar_image_halt(busbar_image* image);

/* ---- Servers: Methods and events ----------------------------------------------------------- */

/* A call of a Method that waits for its answer. */
typedef struct busbar_call busbar_call;

typedef struct busbar_argument {
    const char* name;
    uint8_t type;
    bool is_array; /* of one dimension */
    const char* description;
} busbar_argument;

/* Carries out a Method (Part 4, 5.12.2). Inputs have the types of the arguments, and are valid until
 * the call is finished; ranges are to be checked. Outputs, which begin as null values of their
 * types, are to be set if it returns BUSBAR_GOOD, and what they point at must stay until it returns.
 * Others answer later by busbar_call_finish and return BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY. */
typedef busbar_status (*busbar_method_callback)(void* context, busbar_call* call,
                                                const busbar_value* inputs, size_t input_count,
                                                busbar_value* outputs, size_t output_count);

/* Adds a Method (Part 3, 5.7). */
BUSBAR_C_API busbar_status
busbar_server_add_method(busbar_server* server, const busbar_node* node,
                         const busbar_argument* inputs, size_t input_count,
                         const busbar_argument* outputs, size_t output_count,
                         busbar_method_callback callback, void* context);

/* Answers a call whose callback returned BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY, which must be done
 * once for each, even after the end of the server, and frees it. `outputs` may be null with a bad
 * status. Any thread, not within the callback. */
BUSBAR_C_API busbar_status busbar_call_finish(busbar_call* call, busbar_status status,
                                              const busbar_value* outputs, size_t output_count);

/* A field of an event beyond those of BaseEventType. */
typedef struct busbar_event_field {
    uint16_t namespace_index;
    const char* name;
    busbar_value value;
} busbar_event_field;

/* An event (Part 5, 6.4.2). */
typedef struct busbar_event {
    size_t size; /* sizeof(busbar_event), set by the caller */
    const char* type;        /* null: BaseEventType */
    const char* source_node; /* null: the Server */
    const char* source_name;
    const char* message;
    uint16_t severity; /* 1 to 1,000 */
    busbar_time time;  /* 0: now */
    const busbar_event_field* fields;
    size_t field_count;
} busbar_event;

/* Raises an event for the clients that monitor the Server or a notifier above its source. Never
 * blocks; Bad_ResourceUnavailable if too many wait. Any thread; leaves no text. */
BUSBAR_C_API busbar_status busbar_server_raise_event(busbar_server* server,
                                                     const busbar_event* event);

/* ---- Clients ------------------------------------------------------------------------------- */

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
    const char* url;    /* "opc.tcp://host:port/path"; required */
    const char* policy; /* null: the best that both sides have, none of the deprecated */
    int least_mode;     /* BUSBAR_MODE_...; NONE also allows no security at all */
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
/* As busbar_server_last_error. */
BUSBAR_C_API const char* busbar_client_last_error(const busbar_client* client);

/* Waits for a session (Part 4, 5.7), at most `timeout_ms`: Bad_Timeout, Bad_RequestInterrupted, or
 * the first failure that another attempt cannot cure. It keeps trying in later calls that wait. */
BUSBAR_C_API busbar_status busbar_client_connect(busbar_client* client, uint32_t timeout_ms);
/* Closes session and channel; waits until that is sent, at most two seconds. */
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
 * "/Objects/2:Machine/2:Speed". The functions below return a bad status if the request as a whole
 * failed; otherwise each result has its own. What results point at is valid until the next of these
 * four functions with the same client. */

/* Reads values (Part 4, 5.11.2): `count` of 1 to 1,000,000 nodes into `results`. */
BUSBAR_C_API busbar_status busbar_client_read(busbar_client* client, const char* const* nodes,
                                              size_t count, busbar_data_value* results);
/* Writes values (Part 4, 5.11.4), without status and times, into `count` nodes. */
BUSBAR_C_API busbar_status busbar_client_write(busbar_client* client, const char* const* nodes,
                                               const busbar_value* values, size_t count,
                                               busbar_status* results);
/* Calls a Method (Part 4, 5.12.2) once, and returns its status. Stores where its outputs are and how
 * many in `outputs` and `output_count`, which may both be null. */
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
                                                const busbar_reference** references,
                                                size_t* count);

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
/* Removes a Subscription with its items. Bad_SubscriptionIdInvalid. */
BUSBAR_C_API busbar_status busbar_client_unsubscribe(busbar_client* client, uint32_t subscription);

#ifdef __cplusplus
}
#endif

#endif
