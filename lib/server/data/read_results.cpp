#include "read_results.hpp"

#include <algorithm>

#include "binary/data_value_wire.hpp"
#include "core/utf8.hpp"

namespace busbar::server::detail {

namespace {

const Variant& value_of(const ReadSlot& slot)
{
    return slot.shared != nullptr ? *slot.shared : slot.value;
}

constexpr bool may_have_texts(BuiltInType type)
{
    return type == BuiltInType::String ||
           (type >= BuiltInType::XmlElement && type != BuiltInType::StatusCode);
}

bool is_valid(const String& text)
{
    return busbar::detail::is_valid_text(text.view());
}

bool is_valid(const LocalizedText& text)
{
    return is_valid(text.locale) && is_valid(text.text);
}

/// Encodes the value to look at its texts only.
template <typename T>
bool is_valid(const T& value)
{
    binary::CountingSink sink;
    binary::Writer outer{sink};
    outer.check_texts();
    binary::Writer writer{sink, binary::Writer::Measure{outer}};
    encode(writer, value);
    return writer.status() != status::Bad_EncodingError;
}

bool is_valid(const ExtensionObject& object)
{
    // The body would be copied for nothing.
    return object.body() == ExtensionObject::Body::Binary ? is_valid(object.encoding_id())
                                                          : is_valid<ExtensionObject>(object);
}

template <typename T>
bool are_valid(const Variant& value)
{
    if (const T* const one = value.get_if<T>()) {
        return is_valid(*one);
    }
    const Array<T>& all = *value.array_if<T>();
    return std::all_of(all.begin(), all.end(), [](const T& each) { return is_valid(each); });
}

/// Inline, as most values are numbers.
inline StatusCode checked_status(StatusCode status, const Variant& value)
{
    if (!may_have_texts(value.type()) || status.is_bad() || has_valid_texts(value)) {
        return status;
    }
    constexpr std::uint32_t bits = 0xFFFF; // an overflow, or a change of the value's meaning
    return StatusCode{status::Bad_EncodingError.value() | (status.value() & bits)};
}

} // namespace

bool has_valid_texts(const Variant& value)
{
    switch (value.type()) {
    case BuiltInType::String:
        return are_valid<String>(value);
    case BuiltInType::LocalizedText:
        return are_valid<LocalizedText>(value);
    case BuiltInType::ExtensionObject:
        return are_valid<ExtensionObject>(value);
    default:
        return !may_have_texts(value.type()) || is_valid(value);
    }
}

StatusCode served_status(const ReadSlot& slot)
{
    return checked_status(slot.status, value_of(slot));
}

Timestamps::Timestamps(TimestampsToReturn to_return, DateTime server_time)
    : source{to_return == TimestampsToReturn::Source || to_return == TimestampsToReturn::Both},
      server{to_return == TimestampsToReturn::Server || to_return == TimestampsToReturn::Both
                 ? server_time
                 : DateTime{}}
{
}

Timestamps Timestamps::of_answer(DateTime source_timestamp, DateTime answered) const
{
    Timestamps timestamps = *this;
    if (!server.is_null() && answered > server && source_timestamp > server) {
        timestamps.server = std::min(source_timestamp, answered);
    }
    return timestamps;
}

StatusCode encode_slot(binary::Writer& writer, const ReadSlot& slot, const Timestamps& timestamps)
{
    return encode_data_value(writer, slot, value_of(slot), timestamps);
}

StatusCode encode_data_value(binary::Writer& writer, const DataValue& data, const Variant& value,
                             const Timestamps& timestamps)
{
    const StatusCode status = checked_status(data.status, value);
    const bool has_source = timestamps.source && !data.source_timestamp.is_null();
    busbar::detail::write_data_value(
        writer, {status.is_bad() ? nullptr : &value, status,
                 has_source ? data.source_timestamp : DateTime{},
                 has_source ? data.source_picoseconds : std::uint16_t{0}, timestamps.server, 0});
    return status;
}

void cut_range(ReadSlot& slot, const NumericRange& range)
{
    if (slot.status.is_bad()) {
        return;
    }
    Result<Variant> part = read_range(value_of(slot), range);
    if (part) {
        slot.value = std::move(*part);
        slot.shared = nullptr;
    } else {
        slot.status = part.error();
    }
}

} // namespace busbar::server::detail
