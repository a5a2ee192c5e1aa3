#include "lines.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "tool/printing/display_text.hpp"
#include "tool/printing/value.hpp"
#include "tool/stream/event_stream.hpp"

namespace busbar::tool::admin {

namespace {

constexpr std::string_view current_name = "OPCUA_ExecutionLog.log";
constexpr std::string_view full_prefix = "OPCUA_ExecutionLog_";
constexpr std::string_view log_ending = ".log";
constexpr std::size_t digits_of_time = 17;

constexpr std::size_t entry_width = 5;
constexpr std::size_t time_width = 23;
constexpr std::size_t category_width = 8;
constexpr std::size_t code_width = 8;
constexpr std::size_t most_name_width = 17;
constexpr std::size_t least_name_width = 10;
constexpr std::size_t gaps = 5 * column_gap;
/// Width of all columns except the log's name and the details.
constexpr std::size_t fixed_width = entry_width + time_width + category_width + code_width + gaps;
/// The longest common details, "ERROR BadCertificateUntrusted", are not much longer.
constexpr std::size_t wanted_details = 24;

std::size_t name_width(std::size_t columns)
{
    return columns >= fixed_width + most_name_width + wanted_details ? most_name_width
                                                                     : least_name_width;
}

/// Writes all columns except the last.
std::string front_columns(const std::array<std::string, 6>& texts, std::size_t columns)
{
    const std::string number = cut(texts[0], entry_width);
    return std::string(entry_width - display_width(number), ' ') + number + "  " +
           padded(texts[1], time_width) + "  " + padded(texts[2], category_width) + "  " +
           padded(texts[3], code_width) + "  " + padded(texts[4], name_width(columns));
}

std::string without_end_blanks(std::string line)
{
    line.erase(line.find_last_not_of(' ') + 1);
    return line;
}

/// Splits details such as "SUCCESS", "Basic256Sha256" at tabs.
void append_details(JsonLine& json, std::string_view details)
{
    json.open_array();
    while (!details.empty()) {
        const std::string_view part = details.substr(0, details.find('\t'));
        json.text(part);
        details.remove_prefix(std::min(details.size(), part.size() + 1));
    }
    json.close_array();
}

/// The fields after the standard ones, in the order of OwnField.
constexpr std::array own_fields{"ClientUserId", "SessionId", "Status", "StatusCodeId",
                                "SecureChannelId"};
enum class OwnField : std::uint8_t { User, Session, Status, StatusCode, Channel };

const Variant& own(const EventFields& fields, OwnField which)
{
    return fields[standard_event_fields.size() + static_cast<std::size_t>(which)];
}

/// The text after the message if there is room: why it failed, where, and which user did it.
std::string details(const EventFields& fields, bool is_done)
{
    std::string text;
    const Variant& code = own(fields, OwnField::StatusCode);
    if (const auto* const status = code.get_if<StatusCode>(); status != nullptr && !is_done) {
        text += "  " + text_of(*status);
    }
    text += "  " + plain_text(fields[2]);
    if (const Variant& session = own(fields, OwnField::Session); !session.is_null()) {
        text += "  session " + plain_text(session);
    } else if (const Variant& channel = own(fields, OwnField::Channel); !channel.is_null()) {
        text += "  channel " + plain_text(channel);
    }
    return text;
}

} // namespace

bool is_current_log(std::string_view name)
{
    return name == current_name;
}

bool is_log_name(std::string_view name)
{
    if (is_current_log(name)) {
        return true;
    }
    if (name.size() != full_prefix.size() + digits_of_time + log_ending.size() ||
        !name.starts_with(full_prefix) || !name.ends_with(log_ending)) {
        return false;
    }
    const std::string_view digits = name.substr(full_prefix.size(), digits_of_time);
    return std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::string log_title(std::size_t columns)
{
    std::array<std::string, 6> texts;
    std::copy(controller::execution_log_column_names.begin(),
              controller::execution_log_column_names.end(), texts.begin());
    return front_columns(texts, columns) + "  " + texts[5];
}

std::string log_line(const controller::ExecutionLogEntry& entry, std::size_t columns)
{
    const auto texts = controller::execution_log_columns(entry);
    const std::string details = safe(texts[5]);
    const std::string front = front_columns(texts, columns);
    const std::size_t used = fixed_width + name_width(columns);
    if (columns >= used && display_width(details) <= columns - used) {
        return without_end_blanks(front + "  " + details);
    }
    constexpr std::size_t indent = entry_width + column_gap;
    return without_end_blanks(front) + "\n" + std::string(indent, ' ') +
           wrap(details, std::max(columns, 2 * indent) - indent, indent);
}

void append_entry(JsonLine& json, const controller::ExecutionLogEntry& entry)
{
    const auto columns = controller::execution_log_columns(entry);
    std::string time = columns[1]; // "2017/10/17/14:52:50.878"
    time[4] = time[7] = '-';
    time[10] = 'T';
    json.open_object().member("entry", std::int64_t{entry.serial_number});
    json.member("time", time);
    json.member("category", entry.code->category);
    json.member("code", columns[3]);
    json.member("name", entry.code->name).key("details");
    append_details(json, entry.details);
    json.close_object();
}

std::vector<std::string> audit_fields()
{
    return {own_fields.begin(), own_fields.end()};
}

std::string_view short_name(std::string_view event_type)
{
    constexpr std::string_view kind = "EventType";
    constexpr std::string_view audit = "Audit";
    std::string_view name = event_type;
    if (name.ends_with(kind)) {
        name.remove_suffix(kind.size());
    }
    if (name == audit) {
        return name;
    }
    if (name.starts_with(audit)) {
        name.remove_prefix(audit.size());
    } else if (name.ends_with(audit)) {
        name.remove_suffix(audit.size());
    }
    return name.empty() ? event_type : name;
}

std::string audit_line(const Output& out, std::string_view event, const EventFields& fields,
                       std::size_t columns)
{
    constexpr std::size_t used = 12 + 2 + 18 + 2 + 12 + 2 + 4 + 2;
    const Variant& user = own(fields, OwnField::User);
    const auto* const name = user.get_if<String>();
    const bool is_done = own(fields, OwnField::Status).value_or<bool>(true);
    return padded(time_of_day(fields[0].value_or<DateTime>({})), 12) + "  " +
           padded(safe(event), 18) + "  " +
           padded(name != nullptr && name->empty() ? "-" : plain_text(user), 12) + "  " +
           out.styled(is_done ? Style::Good : Style::Bad, is_done ? "yes " : "no  ") + "  " +
           cut(plain_text(fields[3]) + details(fields, is_done), columns_left(columns, used));
}

} // namespace busbar::tool::admin
