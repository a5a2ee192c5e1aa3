#include "value.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <climits>
#include <cstring>
#include <iterator>
#include <span>
#include <string>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/text_forms.hpp>

#include "guard.hpp"

namespace busbar::c {

namespace {

/// The type in C of a built-in type: of most the same memory, of the others another form.
template <typename T>
struct InC {
    using type = T;
};
// clang-format off
template <> struct InC<DateTime> { using type = busbar_time; };
template <> struct InC<Guid> { using type = busbar_guid; };
template <> struct InC<StatusCode> { using type = busbar_status; };
template <> struct InC<String> { using type = busbar_text; };
template <> struct InC<ByteString> { using type = busbar_text; };
template <> struct InC<XmlElement> { using type = busbar_text; };
template <> struct InC<NodeId> { using type = busbar_text; };
template <> struct InC<ExpandedNodeId> { using type = busbar_text; };
template <> struct InC<QualifiedName> { using type = busbar_qualified_name; };
template <> struct InC<LocalizedText> { using type = busbar_localized_text; };
template <> struct InC<ExtensionObject> { using type = busbar_extension; };
// clang-format on

static_assert(sizeof(bool) == 1 && sizeof(busbar_guid) == sizeof(Guid));
static_assert(sizeof(DateTime) == sizeof(busbar_time));
static_assert(sizeof(StatusCode) == sizeof(busbar_status));

/// True for types whose values are the same bytes in C.
template <typename T>
inline constexpr bool is_plain = std::is_trivially_copyable_v<T> && !std::is_same_v<T, String> &&
                                 !std::is_same_v<T, ByteString> && !std::is_same_v<T, XmlElement>;

template <typename T>
struct TypeTag {
    using type = T;
};

/// Calls `visit` with the tag of the type; false for one that has no form in C.
template <typename Visit>
bool visit_type(unsigned type, Visit visit)
{
    switch (static_cast<BuiltInType>(type)) {
    case BuiltInType::Boolean:
        visit(TypeTag<bool>{});
        return true;
    case BuiltInType::SByte:
        visit(TypeTag<std::int8_t>{});
        return true;
    case BuiltInType::Byte:
        visit(TypeTag<std::uint8_t>{});
        return true;
    case BuiltInType::Int16:
        visit(TypeTag<std::int16_t>{});
        return true;
    case BuiltInType::UInt16:
        visit(TypeTag<std::uint16_t>{});
        return true;
    case BuiltInType::Int32:
        visit(TypeTag<std::int32_t>{});
        return true;
    case BuiltInType::UInt32:
        visit(TypeTag<std::uint32_t>{});
        return true;
    case BuiltInType::Int64:
        visit(TypeTag<std::int64_t>{});
        return true;
    case BuiltInType::UInt64:
        visit(TypeTag<std::uint64_t>{});
        return true;
    case BuiltInType::Float:
        visit(TypeTag<float>{});
        return true;
    case BuiltInType::Double:
        visit(TypeTag<double>{});
        return true;
    case BuiltInType::String:
        visit(TypeTag<String>{});
        return true;
    case BuiltInType::DateTime:
        visit(TypeTag<DateTime>{});
        return true;
    case BuiltInType::Guid:
        visit(TypeTag<Guid>{});
        return true;
    case BuiltInType::ByteString:
        visit(TypeTag<ByteString>{});
        return true;
    case BuiltInType::XmlElement:
        visit(TypeTag<XmlElement>{});
        return true;
    case BuiltInType::NodeId:
        visit(TypeTag<NodeId>{});
        return true;
    case BuiltInType::ExpandedNodeId:
        visit(TypeTag<ExpandedNodeId>{});
        return true;
    case BuiltInType::StatusCode:
        visit(TypeTag<StatusCode>{});
        return true;
    case BuiltInType::QualifiedName:
        visit(TypeTag<QualifiedName>{});
        return true;
    case BuiltInType::LocalizedText:
        visit(TypeTag<LocalizedText>{});
        return true;
    case BuiltInType::ExtensionObject:
        visit(TypeTag<ExtensionObject>{});
        return true;
    default:
        return false;
    }
}

// From C. False for what is malformed.

bool is_text(const busbar_text& text)
{
    return has_all(text.data, text.size) && text.size <= INT_MAX;
}

bool take(const busbar_text& from, String& to)
{
    if (is_text(from) && from.data != nullptr) {
        to = String{std::string_view{from.data, from.size}};
    }
    return is_text(from);
}

bool take(const busbar_text& from, ByteString& to)
{
    if (is_text(from) && from.data != nullptr) {
        to = ByteString{bytes_of(from.data, from.size)};
    }
    return is_text(from);
}

bool take(const busbar_text& from, NodeId& to)
{
    if (!is_text(from) || from.size == 0) {
        return is_text(from);
    }
    auto id = NodeId::parse({from.data, from.size});
    const bool is_good = id.has_value();
    if (is_good) {
        to = *std::move(id);
    }
    return is_good;
}

bool take(const busbar_text& from, ExpandedNodeId& to)
{
    if (!is_text(from) || from.size == 0) {
        return is_text(from);
    }
    auto id = parse_expanded_node_id({from.data, from.size});
    const bool is_good = id.has_value();
    if (is_good) {
        to = *std::move(id);
    }
    return is_good;
}

bool take(const busbar_qualified_name& from, QualifiedName& to)
{
    to.namespace_index = from.namespace_index;
    return take(from.name, to.name);
}

bool take(const busbar_localized_text& from, LocalizedText& to)
{
    return take(from.locale, to.locale) && take(from.text, to.text);
}

bool take(const busbar_extension& from, ExtensionObject& to)
{
    NodeId encoding;
    ByteString body;
    if (!take(from.encoding_id, encoding) || !take(from.body, body)) {
        return false;
    }
    const bool has_body = !body.is_null();
    if (encoding.is_null()) {
        return !has_body;
    }
    to = has_body ? ExtensionObject::from_binary(std::move(encoding), std::move(body))
                  : ExtensionObject::from_id(std::move(encoding));
    return true;
}

// To C.

void give(const String& from, Scratch& /*scratch*/, busbar_text& to)
{
    to = {from.is_null() ? nullptr : from.view().data(), from.size()};
    if (!from.is_null() && to.data == nullptr) {
        to.data = "";
    }
}

void give(const ByteString& from, Scratch& /*scratch*/, busbar_text& to)
{
    to = {nullptr, from.size()};
    if (!from.is_null()) {
        to.data = from.empty() ? "" : reinterpret_cast<const char*>(from.span().data());
    }
}

void give(const NodeId& from, Scratch& scratch, busbar_text& to)
{
    to = scratch.keep(to_string(from));
}

void give(const ExpandedNodeId& from, Scratch& scratch, busbar_text& to)
{
    to = scratch.keep(to_string(from));
}

void give(const QualifiedName& from, Scratch& scratch, busbar_qualified_name& to)
{
    to.namespace_index = from.namespace_index;
    give(from.name, scratch, to.name);
}

void give(const LocalizedText& from, Scratch& scratch, busbar_localized_text& to)
{
    give(from.locale, scratch, to.locale);
    give(from.text, scratch, to.text);
}

void give(const ExtensionObject& from, Scratch& scratch, busbar_extension& to)
{
    give(from.encoding_id(), scratch, to.encoding_id);
    to.body = {};
    if (from.body() == ExtensionObject::Body::Object) {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        from.type()->encode(writer, from.object());
        const auto bytes = sink.take(writer.written());
        to.body = scratch.keep({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    } else if (from.body() == ExtensionObject::Body::Binary) {
        give(from.binary(), scratch, to.body);
    }
}

/// False for a body in XML, which a busbar_extension would show as binary.
bool is_in_binary(const Variant& from)
{
    const auto is_good = [](const ExtensionObject& each) {
        return each.body() != ExtensionObject::Body::Xml;
    };
    if (const auto* const value = from.get_if<ExtensionObject>()) {
        return is_good(*value);
    }
    const auto* const values = from.array_if<ExtensionObject>();
    return values == nullptr || std::all_of(values->begin(), values->end(), is_good);
}

template <typename T>
[[nodiscard]] T loaded(const void* from)
{
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

/// Writes an element that takes a program's form first; false if it is malformed.
template <typename T>
bool write_taken(binary::Writer& writer, const void* from)
{
    T value;
    const bool is_good = take(loaded<typename InC<T>::type>(from), value);
    encode(writer, value);
    return is_good;
}

void write_guid(binary::Writer& writer, const void* from)
{
    const auto guid = loaded<busbar_guid>(from);
    writer.number(guid.data1);
    writer.number(guid.data2);
    writer.number(guid.data3);
    writer.bytes(std::as_bytes(std::span{guid.data4}));
}

/// Writes a value as it is on the wire (Part 6, 5.2.2): one code for all types, which are many.
bool write_element(binary::Writer& writer, unsigned type, const void* from)
{
    switch (type) {
    case BUSBAR_BOOLEAN:
        encode(writer, loaded<std::uint8_t>(from) != 0);
        return true;
    case BUSBAR_GUID:
        write_guid(writer, from);
        return true;
    case BUSBAR_STRING:
    case BUSBAR_XML_ELEMENT:
        return write_taken<String>(writer, from);
    case BUSBAR_BYTE_STRING:
        return write_taken<ByteString>(writer, from);
    case BUSBAR_NODE_ID:
        return write_taken<NodeId>(writer, from);
    case BUSBAR_EXPANDED_NODE_ID:
        return write_taken<ExpandedNodeId>(writer, from);
    case BUSBAR_QUALIFIED_NAME:
        return write_taken<QualifiedName>(writer, from);
    case BUSBAR_LOCALIZED_TEXT:
        return write_taken<LocalizedText>(writer, from);
    case BUSBAR_EXTENSION_OBJECT:
        return write_taken<ExtensionObject>(writer, from);
    default:
        break;
    }
    switch (busbar_type_size(static_cast<std::uint8_t>(type))) {
    case 1:
        writer.number(loaded<std::uint8_t>(from));
        return true;
    case 2:
        writer.number(loaded<std::uint16_t>(from));
        return true;
    case 4:
        writer.number(loaded<std::uint32_t>(from));
        return true;
    default:
        writer.number(loaded<std::uint64_t>(from));
        return true;
    }
}

/// Writes all elements, those that are the same on the wire at once.
bool write_elements(binary::Writer& writer, const busbar_value& from)
{
    const std::size_t size = busbar_type_size(from.type);
    const auto* at = static_cast<const std::byte*>(from.as.array);
    if (std::endian::native == std::endian::little && size <= 8 && from.type != BUSBAR_BOOLEAN) {
        writer.bytes(bytes_of(at, size * from.count));
        return true;
    }
    for (std::uint32_t i = 0; i < from.count; ++i, at += size) {
        if (!write_element(writer, from.type, at)) {
            return false;
        }
    }
    return true;
}

/// Writes a Variant (Part 6, 5.2.2.16); false if it is malformed.
bool write_variant(binary::Writer& writer, const busbar_value& from)
{
    constexpr unsigned array_bit = 0x80;
    constexpr unsigned dimensions_bit = 0x40;
    const bool has_dimensions = from.is_array && from.dimension_count != 0;
    writer.number(static_cast<std::uint8_t>(from.type | (from.is_array ? array_bit : 0U) |
                                            (has_dimensions ? dimensions_bit : 0U)));
    if (!from.is_array) {
        return write_element(writer, from.type, &from.as);
    }
    writer.length(from.count);
    if (!has_all(from.as.array, from.count) || !writer.ok() || !write_elements(writer, from)) {
        return false;
    }
    if (has_dimensions) {
        writer.length(from.dimension_count);
        if (from.dimensions == nullptr || from.dimension_count < 2) {
            return false;
        }
        writer.numbers(std::span{from.dimensions, from.dimension_count});
    }
    return true;
}

/// Reads what write_variant() wrote; the reader checks dimensions.
Result<Variant> read_variant(std::span<const std::byte> bytes)
{
    binary::DecodeLimits limits;
    limits.max_string_length = limits.max_byte_string_length = limits.max_array_length = INT_MAX;
    limits.max_expansion = limits.free_memory = UINT32_MAX;
    return binary::from_bytes<Variant>(bytes, nullptr, limits);
}

template <typename T>
void give_value(const Variant& from, Scratch& scratch, busbar_value& to)
{
    using C = typename InC<T>::type;
    if (const T* const value = from.get_if<T>()) {
        C in_c{};
        if constexpr (is_plain<T>) {
            std::memcpy(&in_c, value, sizeof in_c);
        } else {
            give(*value, scratch, in_c);
        }
        std::memcpy(&to.as, &in_c, sizeof in_c);
        return;
    }
    const Array<T>& values = *from.array_if<T>();
    if constexpr (is_plain<T>) {
        to.as.array = values.data();
    } else {
        C* in_c = scratch.take<C>(values.size());
        to.as.array = in_c;
        for (const T& value : values) {
            give(value, scratch, *in_c++);
        }
    }
}

} // namespace

busbar_text Scratch::keep(std::string_view text)
{
    char* const copy = take<char>(text.size() + 1);
    std::copy_n(text.data(), text.size(), copy);
    copy[text.size()] = '\0';
    return {copy, text.size()};
}

Result<Variant> to_variant(const busbar_value& value)
{
    if (value.type == BUSBAR_NULL) {
        return Variant{};
    }
    if (busbar_type_size(value.type) == 0) {
        return fail(status::Bad_InvalidArgument);
    }
    Result<Variant> result = fail(status::Bad_InvalidArgument);
    if (std::array<std::byte, 32> room; // most values are numbers, which need no memory
        !value.is_array && busbar_type_size(value.type) <= 8) {
        binary::SpanSink sink{room};
        binary::Writer writer{sink};
        if (write_variant(writer, value)) {
            result = read_variant(std::span{room}.first(writer.written()));
        }
    } else {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        if (write_variant(writer, value) && writer.ok()) {
            result = read_variant(sink.take(writer.written()));
        }
    }
    return result || result.error() == status::Bad_OutOfMemory ? std::move(result)
                                                               : fail(status::Bad_InvalidArgument);
}

StatusCode to_c(const Variant& from, Scratch& scratch, busbar_value& to)
{
    to = busbar_value{};
    if (from.is_null()) {
        return status::Good;
    }
    const bool is_known =
        is_in_binary(from) && visit_type(static_cast<unsigned>(from.type()), [&](auto tag) {
            give_value<typename decltype(tag)::type>(from, scratch, to);
        });
    if (!is_known) {
        return status::Bad_NotSupported;
    }
    to.type = static_cast<std::uint8_t>(from.type());
    to.is_array = from.is_array();
    to.count = static_cast<std::uint32_t>(from.array_size());
    to.dimensions = from.dimensions().data();
    to.dimension_count = static_cast<std::uint8_t>(from.dimensions().size());
    return status::Good;
}

StatusCode to_c(const DataValue& from, Scratch& scratch, busbar_data_value& to)
{
    const StatusCode converted = to_c(from.value, scratch, to.value);
    to.status = converted.is_bad() ? converted.value() : from.status.value();
    to.source_time = from.source_timestamp.ticks;
    to.server_time = from.server_timestamp.ticks;
    return converted;
}

Result<NodeId> node_id_of(const char* text)
{
    return text != nullptr ? NodeId::parse(text) : fail(status::Bad_NodeIdInvalid);
}

} // namespace busbar::c

using namespace busbar;

size_t busbar_type_size(uint8_t type)
{
    static constexpr std::uint8_t sizes[] = {
        0,
        1,
        1,
        1,
        2,
        2,
        4,
        4,
        8,
        8,
        4,
        8,
        sizeof(busbar_text),
        8,
        sizeof(busbar_guid),
        sizeof(busbar_text),
        sizeof(busbar_text),
        sizeof(busbar_text),
        sizeof(busbar_text),
        4,
        sizeof(busbar_qualified_name),
        sizeof(busbar_localized_text),
        sizeof(busbar_extension),
    };
    return type < std::size(sizes) ? sizes[type] : 0;
}

busbar_value busbar_value_boolean(bool value)
{
    busbar_value result{};
    result.type = BUSBAR_BOOLEAN;
    result.as.boolean = value;
    return result;
}

busbar_value busbar_value_int32(int32_t value)
{
    busbar_value result{};
    result.type = BUSBAR_INT32;
    result.as.int32 = value;
    return result;
}

busbar_value busbar_value_uint32(uint32_t value)
{
    busbar_value result{};
    result.type = BUSBAR_UINT32;
    result.as.uint32 = value;
    return result;
}

busbar_value busbar_value_double(double value)
{
    busbar_value result{};
    result.type = BUSBAR_DOUBLE;
    result.as.float64 = value;
    return result;
}

busbar_value busbar_value_string(const char* text)
{
    busbar_value result{};
    result.type = BUSBAR_STRING;
    result.as.text = {text, text != nullptr ? std::strlen(text) : 0};
    return result;
}

busbar_value busbar_value_array(uint8_t type, const void* elements, uint32_t count)
{
    busbar_value result{};
    result.type = type;
    result.is_array = true;
    result.count = count;
    result.as.array = elements;
    return result;
}
