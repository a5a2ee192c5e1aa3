#include "value.hpp"

#include <cstdio>
#include <cstdlib>

#include <busbar/client/value_json.hpp>
#include <busbar/client/value_text.hpp>

#include "display_text.hpp"

namespace busbar::tool {

namespace {

/// The names of an option set's bits, "A|B"; empty if a bit has no name.
std::string names_of_bits(std::uint64_t bits, const binary::DynamicType& type)
{
    std::string names;
    for (const auto& bit : type.values) {
        const std::uint64_t place = bit.value < 0 || bit.value > 63
                                        ? 0
                                        : std::uint64_t{1} << static_cast<unsigned>(bit.value);
        if ((bits & place) != 0) {
            bits &= ~place;
            names += (names.empty() ? "" : "|") + bit.name;
        }
    }
    return bits == 0 ? names : std::string{};
}

/// Returns the name of a number; empty if it has none, for example without an enumeration.
std::string name_of_number(const Variant& value, const binary::DynamicType* type)
{
    const bool is_integer =
        value.type() >= BuiltInType::SByte && value.type() <= BuiltInType::UInt64;
    if (type == nullptr || type->values.empty() || value.is_array() || !is_integer) {
        return {};
    }
    const std::string digits = client::to_text(value);
    if (type->kind == binary::DynamicType::Kind::OptionSet) {
        return names_of_bits(std::strtoull(digits.c_str(), nullptr, 10), *type);
    }
    const std::int64_t number = std::strtoll(digits.c_str(), nullptr, 10);
    for (const auto& known : type->values) {
        if (known.value == number) {
            return known.name;
        }
    }
    return {};
}

/// Whether write takes the value in JSON only: "[1, 2]" is both text and JSON.
bool is_written_in_json(const Variant& value, const binary::DynamicType* type)
{
    const bool is_number =
        value.type() <= BuiltInType::Double && (type == nullptr || type->values.empty());
    return (value.is_array() && (!is_number || value.is_matrix())) ||
           value.type() == BuiltInType::ExtensionObject ||
           value.type() == BuiltInType::LocalizedText;
}

} // namespace

const binary::DynamicType* find_type(const Types& types, const NodeId& data_type)
{
    return types == nullptr || data_type.is_null() ? nullptr : types->find(data_type);
}

std::string text_of(const Variant& value, const Types& types, const ValueHints& hints)
{
    client::TextOptions options;
    options.types = types.get();
    options.type = find_type(types, hints.data_type);
    options.limits.max_digits = hints.max_digits;
    return safe(client::to_text(value, options));
}

std::string text_of(const DataValue& value, const Types& types, const ValueHints& hints)
{
    return value.status.is_bad() ? text_of(value.status) : text_of(value.value, types, hints);
}

std::string full_text_of(const DataValue& value, const Types& types, const ValueHints& hints)
{
    const StatusCode code = value.status.code();
    const bool is_plain = code.is_bad() || code == StatusCode{};
    return text_of(value, types, hints) + (is_plain ? "" : "  " + text_of(code));
}

std::string raw_text_of(const DataValue& value, const Types& types, const NodeId& data_type)
{
    const Variant& content = value.value;
    if (value.status.is_bad()) {
        return text_of(value.status);
    }
    const binary::DynamicType* const type = find_type(types, data_type);
    if (is_written_in_json(content, type)) {
        client::JsonOptions options;
        options.types = types.get();
        options.with_types = false;
        return client::to_json(content, options);
    }
    if (const std::string name = name_of_number(content, type); !name.empty()) {
        return safe(name);
    }
    if (const auto* const text = content.get_if<String>()) {
        return safe(text->view());
    }
    if (const auto* const text = content.get_if<XmlElement>()) {
        return safe(text->view());
    }
    if (const auto* const name = content.get_if<QualifiedName>()) {
        return safe(to_string(*name));
    }
    client::TextOptions options;
    options.type = type;
    options.limits = {SIZE_MAX / 8, SIZE_MAX / 8, SIZE_MAX / 8};
    return safe(client::to_text(content, options));
}

std::string text_of(StatusCode status)
{
    if (const std::string_view known = name(status); !known.empty()) {
        return std::string{known};
    }
    char number[16];
    std::snprintf(number, sizeof number, "0x%08X", status.value());
    return number;
}

Style style_of(StatusCode status)
{
    return status.is_bad() ? Style::Bad : status.is_uncertain() ? Style::Uncertain : Style::Plain;
}

std::string time_of_day(DateTime time)
{
    if (time.is_null()) {
        return "-";
    }
    const std::int64_t milliseconds =
        (time.ticks / (DateTime::ticks_per_second / 1'000)) % 86'400'000;
    const auto part = [&](std::int64_t unit, std::int64_t count) {
        return static_cast<int>(milliseconds / unit % count);
    };
    char text[48];
    std::snprintf(text, sizeof text, "%02d:%02d:%02d.%03d", part(3'600'000, 24), part(60'000, 60),
                  part(1'000, 60), part(1, 1'000));
    return text;
}

void append_json(JsonLine& json, const Variant& value, const Types& types)
{
    client::JsonOptions options;
    options.types = types.get();
    options.with_types = false;
    json.raw(client::to_json(value, options));
}

void append_json(JsonLine& json, const DataValue& value, const Types& types,
                 const NodeId& data_type)
{
    json.key("value");
    append_json(json, value.value, types);
    if (const std::string name = name_of_number(value.value, find_type(types, data_type));
        !name.empty()) {
        json.member("valueName", name);
    }
    json.member("type", name(value.value.type()));
    json.member("status", value.status);
    json.member("sourceTimestamp", value.source_timestamp);
    json.member("serverTimestamp", value.server_timestamp);
}

} // namespace busbar::tool
