#include "value_text.hpp"

#include <cstdio>

namespace busbar::example {

namespace {

template <typename T>
std::string scalar_text(const T& value)
{
    if constexpr (std::is_same_v<T, bool>) {
        return value ? "true" : "false";
    } else if constexpr (std::is_floating_point_v<T>) {
        char text[32];
        std::snprintf(text, sizeof text, "%.6g", static_cast<double>(value));
        return text;
    } else if constexpr (std::is_integral_v<T>) {
        return std::to_string(value);
    } else if constexpr (std::is_same_v<T, String>) {
        return "\"" + printable(value.view(), 64) + "\"";
    } else if constexpr (std::is_same_v<T, ByteString>) {
        return std::to_string(value.size()) + " bytes";
    } else {
        return to_string(value);
    }
}

/// Adds the value's text if it holds a T.
template <typename T>
bool append(const Variant& value, std::string& text)
{
    if (const T* scalar = value.get_if<T>()) {
        text += scalar_text(*scalar);
        return true;
    }
    const Array<T>* array = value.array_if<T>();
    if (array == nullptr) {
        return false;
    }
    text += "[";
    for (std::size_t i = 0; i < array->size() && i < 16; ++i) {
        text += (i == 0 ? "" : ", ") + scalar_text((*array)[i]);
    }
    text += array->size() > 16 ? ", ...]" : "]";
    return true;
}

template <typename... T>
std::string first_of(const Variant& value)
{
    std::string text;
    return (append<T>(value, text) || ...) ? text : std::string{name(value.type())};
}

} // namespace

std::string text_of(const DataValue& value, std::size_t width)
{
    std::string text =
        value.status.is_bad()
            ? std::string{name(value.status)}
            : first_of<bool, std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t,
                       std::uint32_t, std::int64_t, std::uint64_t, float, double, String, DateTime,
                       Guid, ByteString>(value.value);
    if (text.size() > width) {
        text = text.substr(0, width - 3) + "...";
    }
    return text;
}

} // namespace busbar::example
