/* Values of the C interface. See busbar/busbar.h for what holds for all functions. */
#ifndef BUSBAR_C_VALUE_H
#define BUSBAR_C_VALUE_H

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

/* A StatusCode. The two uppermost bits say whether it is good (0), uncertain (1) or bad (2). */
typedef uint32_t busbar_status;

#define BUSBAR_GOOD 0x00000000U
/* A callback that answers later returns this. */
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

/* Holds a value of a built-in type, an array or a matrix. It owns nothing: the code that fills it
 * keeps what it points at, for as long as the function says that takes it.
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

/* The number of bytes that a scalar of the type, or an element of an array, takes in a
 * busbar_value; 0 for a type that it cannot have. Any thread. */
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

#ifdef __cplusplus
}
#endif

#endif
