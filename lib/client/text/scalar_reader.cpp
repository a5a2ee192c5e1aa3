#include "scalar_reader.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

#include <busbar/core/text_forms.hpp>

#include "binary/dynamic/iec_type.hpp"
#include "core/base64.hpp"
#include "core/number_text.hpp"
#include "core/visit_built_in.hpp"

namespace busbar::client::detail {

namespace {

bool is_text(const Json& from)
{
    return from.kind == Json::Kind::String;
}

template <typename T>
bool read_number(const Json& from, T& to)
{
    if (from.kind != Json::Kind::Number && !is_text(from)) {
        return false;
    }
    const char* const end = from.text.data() + from.text.size();
    const auto [stop, error] = busbar::detail::read_number(from.text.data(), end, to);
    return error == std::errc{} && stop == end;
}

template <typename T>
bool take(std::optional<T> found, T& to)
{
    if (found) {
        to = *std::move(found);
    }
    return found.has_value();
}

/// "0x00FF".
std::optional<std::vector<std::byte>> from_hexadecimal(std::string_view text)
{
    std::vector<std::byte> bytes;
    text.remove_prefix(2);
    if (text.size() % 2 != 0) {
        return std::nullopt;
    }
    for (; !text.empty(); text.remove_prefix(2)) {
        std::uint8_t byte = 0;
        const char* const end = text.data() + 2;
        if (std::from_chars(text.data(), end, byte, 16).ptr != end) {
            return std::nullopt;
        }
        bytes.push_back(std::byte{byte});
    }
    return bytes;
}

template <typename T>
std::string range_of()
{
    return ", " + std::to_string(std::numeric_limits<T>::min()) + " to " +
           std::to_string(std::numeric_limits<T>::max());
}

std::string iec_example(binary::detail::IecKind kind)
{
    using Kind = binary::detail::IecKind;
    switch (kind) {
    case Kind::Duration:
        return "a time such as T#1s500ms, or milliseconds";
    case Kind::TimeOfDay:
        return "a time of day such as TOD#06:00:00";
    case Kind::Date:
        return "a date such as D#2026-11-21";
    case Kind::DateAndTime:
        break;
    }
    return "a date and time such as DT#2026-11-21-06:00:00";
}

} // namespace

bool read_scalar(const Json& from, bool& to)
{
    to = from.kind == Json::Kind::True || from.text == "true" || from.text == "1";
    return to || from.kind == Json::Kind::False || from.text == "false" || from.text == "0";
}

bool read_scalar(const Json& from, std::int8_t& to)
{
    return read_number(from, to);
}
bool read_scalar(const Json& from, std::uint8_t& to)
{
    return read_number(from, to);
}
bool read_scalar(const Json& from, std::int16_t& to)
{
    return read_number(from, to);
}
bool read_scalar(const Json& from, std::uint16_t& to)
{
    return read_number(from, to);
}
bool read_scalar(const Json& from, std::int32_t& to)
{
    return read_number(from, to);
}
bool read_scalar(const Json& from, std::uint32_t& to)
{
    return read_number(from, to);
}
bool read_scalar(const Json& from, std::int64_t& to)
{
    return read_number(from, to);
}
bool read_scalar(const Json& from, std::uint64_t& to)
{
    return read_number(from, to);
}
bool read_scalar(const Json& from, float& to)
{
    return read_number(from, to); // NaN and Infinity are among what it reads
}
bool read_scalar(const Json& from, double& to)
{
    return read_number(from, to);
}

bool read_scalar(const Json& from, String& to)
{
    to = is_text(from) ? String{from.text} : String{};
    return is_text(from) || from.kind == Json::Kind::Null;
}

bool read_scalar(const Json& from, XmlElement& to)
{
    String text;
    const bool is_read = read_scalar(from, text);
    to = XmlElement{std::move(text)};
    return is_read;
}

bool read_scalar(const Json& from, DateTime& to)
{
    return is_text(from) && take(parse_date_time(from.text), to);
}

bool read_scalar(const Json& from, Guid& to)
{
    const auto guid = Guid::parse(from.text);
    to = guid.value_or(Guid{});
    return is_text(from) && guid;
}

bool read_scalar(const Json& from, ByteString& to)
{
    if (from.kind == Json::Kind::Null) {
        to = {};
        return true;
    }
    const auto bytes = from.text.starts_with("0x") ? from_hexadecimal(from.text)
                                                   : busbar::detail::from_base64(from.text);
    if (bytes) {
        to = ByteString{std::span{*bytes}};
    }
    return is_text(from) && bytes;
}

bool read_scalar(const Json& from, NodeId& to)
{
    auto id = NodeId::parse(from.text);
    if (id) {
        to = *std::move(id);
    }
    return is_text(from) && id;
}

bool read_scalar(const Json& from, ExpandedNodeId& to)
{
    return is_text(from) && take(parse_expanded_node_id(from.text), to);
}

bool read_scalar(const Json& from, StatusCode& to)
{
    const Json* const code = from.find("Code");
    if (from.kind == Json::Kind::Object) {
        return code != nullptr && code->kind == Json::Kind::Number && read_scalar(*code, to);
    }
    return take(parse_status_code(from.text), to);
}

bool read_scalar(const Json& from, QualifiedName& to)
{
    const std::size_t colon = from.text.find(':');
    std::uint16_t index = 0;
    const char* const end = from.text.data() + (colon == std::string::npos ? 0 : colon);
    const bool has_index = colon != 0 && std::from_chars(from.text.data(), end, index).ptr == end &&
                           end != from.text.data();
    to = {has_index ? index : std::uint16_t{0},
          String{std::string_view{from.text}.substr(has_index ? colon + 1 : 0)}};
    return is_text(from);
}

bool read_scalar(const Json& from, LocalizedText& to)
{
    if (from.kind != Json::Kind::Object) {
        return read_scalar(from, to.text);
    }
    const Json* const locale = from.find("Locale");
    const Json* const text = from.find("Text");
    return (locale == nullptr || read_scalar(*locale, to.locale)) &&
           (text == nullptr || read_scalar(*text, to.text));
}

std::optional<std::int64_t> number_of_name(std::string_view text, const binary::DynamicType& type)
{
    const bool is_set = type.kind == binary::DynamicType::Kind::OptionSet;
    std::uint64_t number = 0;
    for (bool is_over = false; !is_over;) {
        const std::size_t end = is_set ? std::min(text.find('|'), text.size()) : text.size();
        const std::string_view name = text.substr(0, end);
        const auto found = std::find_if(type.values.begin(), type.values.end(),
                                        [&](const auto& value) { return value.name == name; });
        if (found == type.values.end() || (is_set && (found->value < 0 || found->value > 63))) {
            return std::nullopt;
        }
        number |= is_set ? std::uint64_t{1} << static_cast<unsigned>(found->value)
                         : static_cast<std::uint64_t>(found->value);
        is_over = end == text.size();
        text.remove_prefix(is_over ? end : end + 1);
    }
    return static_cast<std::int64_t>(number);
}

std::string expectation(BuiltInType type, const binary::DynamicType* named)
{
    if (const auto iec = binary::detail::iec_type(named)) {
        return iec_example(iec->kind);
    }
    switch (type) {
    case BuiltInType::Boolean:
        return "a Boolean, true or false";
    case BuiltInType::DateTime:
        return "a DateTime such as 2026-11-21T06:00:00Z";
    case BuiltInType::Guid:
        return "a Guid such as 72962B91-FA75-4AE6-8D28-B404DC7DAF63";
    case BuiltInType::ByteString:
        return "a ByteString in base64, or in hexadecimal after 0x";
    case BuiltInType::NodeId:
        return "a NodeId such as ns=2;s=Pump";
    case BuiltInType::StatusCode:
        return "a StatusCode such as Bad_Timeout or 0x800A0000";
    default:
        break;
    }
    std::string text = "a value of type " + std::string{name(type)};
    if (type >= BuiltInType::SByte && type <= BuiltInType::UInt64) {
        busbar::detail::visit_built_in(type, [&](auto tag) {
            using T = typename decltype(tag)::type;
            if constexpr (std::is_integral_v<T>) {
                const bool has_vowel = name(type).starts_with("Int") || type == BuiltInType::SByte;
                text = (has_vowel ? "an " : "a ") + std::string{name(type)} + range_of<T>();
            }
        });
    }
    return text;
}

std::string expectation(const binary::DynamicType& type)
{
    constexpr std::size_t enough = 10;
    std::string text = "a number or name of " + printable(type.name) + ":";
    for (std::size_t i = 0; i < type.values.size(); ++i) {
        text += i == 0 ? " " : ", ";
        if (i == enough) {
            return text + "...";
        }
        text += printable(type.values[i].name, 64);
    }
    return text;
}

} // namespace busbar::client::detail
