#include <busbar/harness/text.hpp>

#include <array>
#include <charconv>

#include "core/visit_built_in.hpp"

namespace busbar::harness {

namespace {

constexpr std::size_t max_elements = 16;

template <typename T>
std::string scalar_text(const T& value)
{
    if constexpr (std::is_same_v<T, bool>) {
        return value ? "true" : "false";
    } else if constexpr (std::is_arithmetic_v<T>) {
        std::array<char, 32> text{};
        const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
        return {text.data(), end};
    } else if constexpr (std::is_same_v<T, String>) {
        return value.is_null() ? "null" : "\"" + printable(value.view()) + "\"";
    } else if constexpr (std::is_same_v<T, ByteString> || std::is_same_v<T, XmlElement>) {
        return std::to_string(value.size()) + " bytes";
    } else if constexpr (std::is_same_v<T, StatusCode> || std::is_same_v<T, Variant> ||
                         std::is_same_v<T, DataValue>) {
        return text_of(value);
    } else if constexpr (std::is_same_v<T, LocalizedText>) {
        return "\"" + printable(value.text.view()) + "\"";
    } else if constexpr (std::is_same_v<T, ExtensionObject> || std::is_same_v<T, DiagnosticInfo>) {
        return "...";
    } else {
        return to_string(value);
    }
}

template <typename T>
std::string array_text(const Array<T>& array)
{
    std::string text = "[" + std::to_string(array.size()) + "] {";
    for (std::size_t i = 0; i < array.size() && i < max_elements; ++i) {
        text += (i == 0 ? "" : ", ") + scalar_text(array[i]);
    }
    return text + (array.size() > max_elements ? ", ...}" : "}");
}

} // namespace

std::string text_of(StatusCode code)
{
    if (code == code.code() && !name(code).empty()) {
        return std::string{name(code)};
    }
    std::array<char, 16> digits{};
    const auto end =
        std::to_chars(digits.data(), digits.data() + digits.size(), code.value(), 16).ptr;
    const std::string number = "0x" + std::string{digits.data(), end};
    return name(code).empty() ? number : std::string{name(code)} + " (" + number + ")";
}

std::string text_of(const Variant& value)
{
    if (value.is_null()) {
        return "null";
    }
    return std::string{name(value.type())} +
           busbar::detail::visit_built_in(value.type(), [&](auto tag) {
               using T = typename decltype(tag)::type;
               if constexpr (!std::is_same_v<T, Variant>) {
                   if (const T* const scalar = value.get_if<T>()) {
                       return " " + scalar_text(*scalar);
                   }
               }
               const Array<T>* const array = value.array_if<T>();
               return array != nullptr ? array_text(*array) : std::string{};
           });
}

std::string text_of(const DataValue& value)
{
    std::string text = text_of(value.value);
    if (value.status != StatusCode{}) {
        text += ", " + text_of(value.status);
    }
    if (value.source_timestamp != DateTime{}) {
        text += ", source " + to_string(value.source_timestamp);
    }
    if (value.server_timestamp != DateTime{}) {
        text += ", server " + to_string(value.server_timestamp);
    }
    return text;
}

} // namespace busbar::harness
