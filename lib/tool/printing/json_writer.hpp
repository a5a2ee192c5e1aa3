#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/date_time.hpp>
#include <busbar/core/status_code.hpp>

#include "core/json_writer.hpp"

namespace busbar::tool {

/// Writes one JSON document (RFC 8259) on one line. Members are written in the order of the calls;
/// the caller closes what it opens.
class JsonLine {
public:
    JsonLine& open_object();
    JsonLine& close_object();
    JsonLine& open_array();
    JsonLine& close_array();
    JsonLine& key(std::string_view name);

    /// Bytes that are not UTF-8 become U+FFFD.
    JsonLine& text(std::string_view value);
    /// An array of them.
    JsonLine& texts(std::span<const std::string> values);
    JsonLine& number(std::int64_t value) { return raw(std::to_string(value)); }
    JsonLine& number(double value);
    JsonLine& boolean(bool value) { return raw(value ? "true" : "false"); }
    JsonLine& null() { return raw("null"); }
    /// Appends JSON from another source.
    JsonLine& raw(std::string_view json);

    JsonLine& member(std::string_view name, std::string_view value)
    {
        return key(name).text(value);
    }
    JsonLine& member(std::string_view name, const char* value) { return key(name).text(value); }
    JsonLine& member(std::string_view name, bool value) { return key(name).boolean(value); }
    JsonLine& member(std::string_view name, std::int64_t value) { return key(name).number(value); }
    JsonLine& member(std::string_view name, double value) { return key(name).number(value); }
    /// Null for no time.
    JsonLine& member(std::string_view name, DateTime value);
    /// {"code": 2147483648, "symbol": "Bad"}, as Part 6, 5.4.2.12 has it.
    JsonLine& member(std::string_view name, StatusCode value);

    [[nodiscard]] const std::string& document() const { return json_.document(); }

private:
    busbar::detail::JsonWriter json_;
};

} // namespace busbar::tool
