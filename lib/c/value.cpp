#include "value.hpp"

#include <climits>
#include <cstring>
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

bool take(const busbar_text& from, XmlElement& to)
{
    String text;
    const bool is_good = take(from, text);
    to = XmlElement{std::move(text)};
    return is_good;
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
    if (!encoding.is_null()) {
        to = body.is_null() ? ExtensionObject::from_id(std::move(encoding))
                            : ExtensionObject::from_binary(std::move(encoding), std::move(body));
    }
    return body.is_null() || !to.is_null();
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
    } else {
        give(from.xml(), scratch, to.body);
    }
}

/// Any byte but 0 is true: others than 0 and 1 must not get into a bool.
bool is_true(const void* boolean)
{
    return *static_cast<const unsigned char*>(boolean) != 0;
}

template <typename T>
bool take_scalar(const busbar_value& from, Variant& to)
{
    T value{};
    bool is_good = true;
    if constexpr (std::is_same_v<T, bool>) {
        value = is_true(&from.as);
    } else if constexpr (is_plain<T>) {
        std::memcpy(static_cast<void*>(&value), &from.as, sizeof value);
    } else {
        typename InC<T>::type in_c;
        std::memcpy(&in_c, &from.as, sizeof in_c);
        is_good = take(in_c, value);
    }
    to = Variant{std::move(value)};
    return is_good;
}

template <typename T>
bool take_array(const busbar_value& from, Array<std::uint32_t> dimensions, Variant& to)
{
    Array<T> values;
    values.resize(from.count);
    const auto* in_c = static_cast<const typename InC<T>::type*>(from.as.array);
    if constexpr (std::is_same_v<T, bool>) {
        for (bool& value : values) {
            value = is_true(in_c++);
        }
    } else if constexpr (is_plain<T>) {
        if (from.count != 0) {
            std::memcpy(static_cast<void*>(values.data()), in_c, from.count * sizeof(T));
        }
    } else {
        for (T& value : values) {
            if (!take(*in_c++, value)) {
                return false;
            }
        }
    }
    to = Variant::matrix(std::move(values), std::move(dimensions));
    return true;
}

/// False if the dimensions are not those of the elements.
bool take_dimensions(const busbar_value& from, Array<std::uint32_t>& to)
{
    if (from.dimension_count == 0) {
        return true;
    }
    if (from.dimension_count < 2 || from.dimensions == nullptr) {
        return false;
    }
    std::uint64_t product = 1;
    for (const std::uint32_t each : std::span{from.dimensions, from.dimension_count}) {
        product *= each;
        if (product > from.count) {
            return false;
        }
        to.push_back(each);
    }
    return product == from.count;
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
    std::memcpy(copy, text.data(), text.size());
    copy[text.size()] = '\0';
    return {copy, text.size()};
}

Result<Variant> to_variant(const busbar_value& value)
{
    Variant result;
    if (value.type == BUSBAR_NULL) {
        return result;
    }
    Array<std::uint32_t> dimensions;
    if (value.is_array &&
        (!has_all(value.as.array, value.count) || !take_dimensions(value, dimensions))) {
        return fail(status::Bad_InvalidArgument);
    }
    bool is_good = true;
    const bool is_known = visit_type(value.type, [&](auto tag) {
        using T = typename decltype(tag)::type;
        is_good = value.is_array ? take_array<T>(value, std::move(dimensions), result)
                                 : take_scalar<T>(value, result);
    });
    if (!is_known || !is_good) {
        return fail(status::Bad_InvalidArgument);
    }
    return result;
}

StatusCode to_c(const Variant& from, Scratch& scratch, busbar_value& to)
{
    to = busbar_value{};
    if (from.is_null()) {
        return status::Good;
    }
    const bool is_known = visit_type(static_cast<unsigned>(from.type()), [&](auto tag) {
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

void to_c(const DataValue& from, Scratch& scratch, busbar_data_value& to)
{
    const StatusCode converted = to_c(from.value, scratch, to.value);
    to.status = converted.is_bad() ? converted.value() : from.status.value();
    to.source_time = from.source_timestamp.ticks;
    to.server_time = from.server_timestamp.ticks;
}

Result<NodeId> node_id_of(const char* text)
{
    return text != nullptr ? NodeId::parse(text) : fail(status::Bad_NodeIdInvalid);
}

} // namespace busbar::c

using namespace busbar;

size_t busbar_type_size(uint8_t type)
{
    size_t size = 0;
    c::visit_type(type, [&](auto tag) {
        size = sizeof(typename c::InC<typename decltype(tag)::type>::type);
    });
    return size;
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
