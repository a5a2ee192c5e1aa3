#include "json_writer.hpp"

#include <cmath>
#include <cstdio>

#include <busbar/core/text.hpp>

namespace busbar::tool {

JsonLine& JsonLine::open_object()
{
    json_.begin_object();
    return *this;
}

JsonLine& JsonLine::close_object()
{
    json_.end_object();
    return *this;
}

JsonLine& JsonLine::open_array()
{
    json_.begin_list();
    return *this;
}

JsonLine& JsonLine::close_array()
{
    json_.end_list();
    return *this;
}

JsonLine& JsonLine::key(std::string_view name)
{
    json_.name(name);
    return *this;
}

JsonLine& JsonLine::text(std::string_view value)
{
    json_.string(value);
    return *this;
}

JsonLine& JsonLine::texts(std::span<const std::string> values)
{
    open_array();
    for (const std::string& value : values) {
        text(value);
    }
    return close_array();
}

JsonLine& JsonLine::number(double value)
{
    if (!std::isfinite(value)) {
        return null();
    }
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    return raw(text);
}

JsonLine& JsonLine::raw(std::string_view json)
{
    json_.word(json);
    return *this;
}

JsonLine& JsonLine::member(std::string_view name, DateTime value)
{
    return value.is_null() ? key(name).null() : key(name).text(to_string(value));
}

JsonLine& JsonLine::member(std::string_view name, StatusCode value)
{
    key(name).open_object();
    key("code").number(static_cast<std::int64_t>(value.value()));
    if (const std::string_view symbol = busbar::name(value); !symbol.empty()) {
        member("symbol", symbol);
    }
    return close_object();
}

} // namespace busbar::tool
