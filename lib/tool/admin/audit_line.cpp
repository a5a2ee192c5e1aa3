#include "audit_line.hpp"

#include <array>
#include <cstdint>

#include "tool/printing/display_text.hpp"
#include "tool/printing/value.hpp"

namespace busbar::tool::admin {

namespace {

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
