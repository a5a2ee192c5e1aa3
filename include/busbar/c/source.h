/* Servers of the C interface: sources of many values, structures, process images, Methods and
 * events. See busbar/busbar.h for what holds for all functions. */
#ifndef BUSBAR_C_SOURCE_H
#define BUSBAR_C_SOURCE_H

#include <busbar/c/server.h>
#include <busbar/c/value.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Servers: sources of many values ------------------------------------------------------- */

/* Reads or writes that wait for a source. */
typedef struct busbar_batch busbar_batch;

/* One value that is wanted; begins as Bad_NoCommunication. */
typedef struct busbar_read_item {
    uint64_t handle;
    busbar_data_value result;
} busbar_read_item;

/* One value to write, of the variable's type, and what came of it; begins as Bad_NoCommunication.
 * Values that a busbar_value cannot hold are answered with Bad_NotSupported and not passed on. */
typedef struct busbar_write_item {
    uint64_t handle;
    busbar_data_value value;
    busbar_status result;
} busbar_write_item;

/* A bus, a PLC: serves the variables that name it, those of one service call together (Part 4,
 * 5.11). A callback returns BUSBAR_GOOD when all items are done, a bad status for all of them, or
 * BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY and calls busbar_batch_complete later. The items are valid
 * until then; what results point at must stay until the batch is complete. While 256 batches are
 * not complete, late ones included, further items answer Bad_TooManyOperations. */
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

/* Ends a batch whose callback returned BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY, which must be done
 * once for each, even after its timeout and the end of the server. With a bad `status` all items
 * have it. Frees the batch with its items. Any thread, not within the callback. */
BUSBAR_C_API busbar_status busbar_batch_complete(busbar_batch* batch, busbar_status status);

/* ---- Servers: structures and process image ------------------------------------------------- */

/* A structure of the server: its DataType, and its form in memory. */
typedef struct busbar_structure busbar_structure;

/* A text in the memory of a structure or an image: its length, or 2^32-1 if it is null, and room
 * for `capacity` bytes, which are not terminated. Declares a member. */
#define BUSBAR_TEXT_MEMBER(name, capacity)                                                         \
    struct {                                                                                       \
        uint32_t size;                                                                             \
        char data[capacity];                                                                       \
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
 * Stores a handle, which belongs to the server. Types are not removed: after Bad_OutOfMemory the
 * DataType may be there. */
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
    size_t size;  /* sizeof(busbar_image_config), set by the caller */
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

/* Carries out a Method (Part 4, 5.12.2). Inputs have the types of the arguments, and are valid
 * until the call is finished; ranges are to be checked. Outputs, which begin as null values of
 * their types, arrays without elements among them, are to be set if it returns BUSBAR_GOOD, and
 * what they point at must stay until it returns. Others answer later by busbar_call_finish and
 * return BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY. The client has Bad_Timeout if that takes more than
 * 5 seconds, and Bad_TooManyOperations while 256 requests with such calls are unfinished. */
typedef busbar_status (*busbar_method_callback)(void* context, busbar_call* call,
                                                const busbar_value* inputs, size_t input_count,
                                                busbar_value* outputs, size_t output_count);

/* Adds a Method (Part 3, 5.7). */
BUSBAR_C_API busbar_status busbar_server_add_method(busbar_server* server, const busbar_node* node,
                                                    const busbar_argument* inputs,
                                                    size_t input_count,
                                                    const busbar_argument* outputs,
                                                    size_t output_count,
                                                    busbar_method_callback callback, void* context);

/* Answers a call whose callback returned BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY, which must be done
 * once for each, even after the end of the server, and frees it. With a bad status `outputs` and
 * `output_count` are ignored. Any thread, not within the callback. */
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
    size_t size;             /* sizeof(busbar_event), set by the caller */
    const char* type;        /* null: BaseEventType */
    const char* source_node; /* null: the Server */
    const char* source_name;
    const char* message;
    uint16_t severity; /* 1 to 1,000; 0: 1 */
    busbar_time time;  /* 0: now */
    const busbar_event_field* fields;
    size_t field_count;
} busbar_event;

/* Raises an event for the clients that monitor the Server or a notifier above its source. Never
 * blocks; Bad_ResourceUnavailable if too many wait, Bad_InvalidArgument. Any thread; leaves no
 * text. */
BUSBAR_C_API busbar_status busbar_server_raise_event(busbar_server* server,
                                                     const busbar_event* event);

#ifdef __cplusplus
}
#endif

#endif
