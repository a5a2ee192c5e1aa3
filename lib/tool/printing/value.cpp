#include "value.hpp"

#include <cstdio>

#include <busbar/client/value_json.hpp>
#include <busbar/client/value_text.hpp>

#include "display_text.hpp"

namespace busbar::tool {

std::string text_of(const Variant& value, const Types& types)
{
    client::TextOptions options;
    options.types = types.get();
    return safe(client::to_text(value, options));
}

std::string text_of(const DataValue& value, const Types& types)
{
    return value.status.is_bad() ? text_of(value.status) : text_of(value.value, types);
}

std::string full_text_of(const DataValue& value, const Types& types)
{
    const StatusCode code = value.status.code();
    const bool is_plain = code.is_bad() || code == StatusCode{};
    return text_of(value, types) + (is_plain ? "" : "  " + text_of(code));
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

void append_json(JsonLine& json, const DataValue& value, const Types& types)
{
    json.key("value");
    append_json(json, value.value, types);
    json.member("type", name(value.value.type()));
    json.member("status", value.status);
    json.member("sourceTimestamp", value.source_timestamp);
    json.member("serverTimestamp", value.server_timestamp);
}

} // namespace busbar::tool
