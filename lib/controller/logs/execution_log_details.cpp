#include "execution_log_details.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <initializer_list>

#include <busbar/core/node_id.hpp>
#include <busbar/core/status_codes.hpp>

#include "log_text.hpp"

namespace busbar::controller::detail {

namespace {

/// Returns an IPv4 address as people write it, even if the socket is an IPv6 one.
std::string_view plain_address(std::string_view address)
{
    constexpr std::string_view mapped = "::ffff:";
    return address.starts_with(mapped) && address.find('.') != std::string_view::npos
               ? address.substr(mapped.size())
               : address;
}

constexpr std::size_t max_logged_file_name = 65;

using Items = std::vector<LogDetails>;

std::string tabbed(std::initializer_list<std::string_view> parts)
{
    std::string result;
    for (const std::string_view part : parts) {
        result.append(part).append("\t");
    }
    result.pop_back(); // `result` has at least one part
    return result;
}

std::string logged_name(std::string_view text)
{
    return clean_text(text, max_logged_name);
}

std::string byte_text(std::uint64_t size)
{
    return std::to_string(size) + "Byte";
}

/// Takes 32 bits from an id; those of a Guid are random and tell sessions apart.
std::uint32_t number_of(const NodeId& id)
{
    if (id.is_numeric()) {
        return id.numeric();
    }
    if (id.id_type() == IdType::Guid) {
        return id.guid().data1;
    }
    std::uint32_t hash = 2'166'136'261U; // FNV-1a
    for (const char c : to_string(id)) {
        hash = (hash ^ static_cast<unsigned char>(c)) * 16'777'619U;
    }
    return hash;
}

std::string session_text(const Record& record)
{
    std::array<char, 16> text{};
    const std::uint32_t number =
        record.actor.session_id == nullptr ? 0 : number_of(*record.actor.session_id);
    std::snprintf(text.data(), text.size(), "0x%08X", static_cast<unsigned>(number));
    return text.data();
}

std::string user_text(const Record& record)
{
    return record.actor.user.empty() ? "Anonymous" : logged_name(record.actor.user);
}

/// Returns the client's name: the examples of 7-1-7 show the common name of its certificate.
std::string host_text(const Record& record)
{
    const auto facts = facts_of(record.certificate);
    return logged_name(facts ? std::string_view{facts->common_name} : record.actor.application_uri);
}

std::string certificate_columns(const Record& record)
{
    const auto facts = facts_of(record.certificate);
    return facts ? tabbed({logged_name(facts->common_name), utc_text(facts->valid_to)}) : "\t";
}

/// Returns the list that a field names, for example "TRUSTED".
std::string store_text(const Record& record, std::string_view field_name)
{
    const std::string_view list = text_field(record, field_name);
    return list == "trusted"    ? "TRUSTED"
           : list == "issuers"  ? "ISSUER"
           : list == "rejected" ? "REJECTED"
                                : logged_name(list);
}

// Of the category SERVER.

Items log_started(const Record&, DateTime)
{
    return {{"Start", ""}};
}

Items log_preparing(const Record&, DateTime)
{
    return {{"Prepare", ""}};
}

Items log_running(const Record&, DateTime)
{
    return {{"Run", ""}};
}

Items log_shut_down(const Record&, DateTime)
{
    return {{"Shutdown", ""}};
}

Items log_halted(const Record& record, DateTime)
{
    return {{"HaltError", logged_name(text_field(record, "Reason"))}};
}

Items log_limit(const Record& record, DateTime)
{
    return {{"MaxVariables", logged_name(text_field(record, "Limit"))}};
}

Items log_not_published(const Record& record, DateTime)
{
    const std::string reason = logged_name(text_field(record, "Reason"));
    std::string details = tabbed({logged_name(text_field(record, "Name")), reason});
    if (reason == "MaxSize") {
        details += "\t" + byte_text(number_field(record, "Size"));
    }
    return {{"InvalidDataType", std::move(details)}};
}

Items log_counted(const Record& record, DateTime)
{
    const auto count = [&](std::string_view name) {
        return std::string{name} + "=" + std::to_string(number_field(record, name));
    };
    return {{"NumOfVariables",
             count("Variables") + ", " + count("Values") + ", " + count("DataTypes")}};
}

Items log_published(const Record& record, DateTime)
{
    return {{"PublishedVariable", tabbed({logged_name(text_field(record, "Name")),
                                          byte_text(number_field(record, "Size")),
                                          std::to_string(number_field(record, "Values")),
                                          std::to_string(number_field(record, "Members"))})}};
}

// Of the category AUTH.

/// Returns the message with the same meaning from the list in W588, 7-1-6 *2.
StatusCode application_error(StatusCode status)
{
    if (status == status::Bad_CertificateChainIncomplete) {
        return status::Bad_CertificateUntrusted;
    }
    return status == status::Bad_CertificateRevocationUnknown
               ? StatusCode{status::Bad_CertificateIssuerRevocationUnknown}
               : status;
}

Items log_application_error(const Record& record, DateTime)
{
    return {{"Application", tabbed({"ERROR", status_text(application_error(record.status))})}};
}

/// Records an activated session. The first activation proves that the session belongs to the
/// application; the examples of 7-1-7 record that after the user.
Items log_activated(const Record& record, DateTime)
{
    const std::string session = session_text(record);
    Items items{{"User", tabbed({"Success", session, user_text(record)})}};
    if (flag_field(record, "IsFirst", true)) {
        items.push_back({"Application",
                         tabbed({"OPEN", session, logged_name(plain_address(record.actor.address)),
                                 host_text(record)})});
    }
    return items;
}

Items log_login_refused(const Record& record, DateTime now)
{
    if (record.status == status::Bad_ApplicationSignatureInvalid) {
        return log_application_error(record, now);
    }
    return {{"User", tabbed({"ERROR", user_text(record), status_text(record.status)})}};
}

Items log_closed(const Record& record, DateTime)
{
    if (!flag_field(record, "WasActivated", true)) {
        return {};
    }
    return {{"Application", tabbed({"CLOSE", session_text(record)})}};
}

Items log_security_settings(const Record& record, DateTime)
{
    return record.status.is_bad() ? Items{} : Items{{"Update", ""}};
}

/// Users and roles have records of their own; of the settings only those of security are recorded
/// here (W588, 3-2-6).
Items log_settings(const Record& record, DateTime now)
{
    return flag_field(record, "IsSecurity", false) ? log_security_settings(record, now) : Items{};
}

// Of the category CERT.

Items log_own_updated(const Record& record, DateTime)
{
    return record.status.is_bad() ? Items{} : Items{{"Update_Server", certificate_columns(record)}};
}

Items log_expiring(const Record& record, DateTime now)
{
    const auto facts = facts_of(record.certificate);
    // This kind also reports a certificate that is not valid yet, for which there is no code.
    return facts && now < facts->valid_from ? Items{}
                                            : Items{{"Notify_Server", certificate_columns(record)}};
}

Items log_expired(const Record& record, DateTime)
{
    if (text_field(record, "ListName").empty()) {
        return {{"Expired_Server", certificate_columns(record)}};
    }
    return {{"Expired_Client",
             tabbed({certificate_columns(record), "CLIENT", store_text(record, "ListName")})}};
}

Items log_mismatch(const Record& record, DateTime)
{
    return {{"Mismatch_Host", certificate_columns(record)}};
}

Items log_added(const Record& record, DateTime)
{
    return {
        {"Add", tabbed({certificate_columns(record), "CLIENT", store_text(record, "ListName")})}};
}

Items log_removed(const Record& record, DateTime)
{
    return {{"Delete",
             tabbed({certificate_columns(record), "CLIENT", store_text(record, "ListName")})}};
}

Items log_moved(const Record& record, DateTime)
{
    const std::string way =
        store_text(record, "FromListName") + "->" + store_text(record, "ListName");
    return {{"Move", tabbed({certificate_columns(record), "CLIENT", way})}};
}

Items log_discarded(const Record& record, DateTime)
{
    return {{"Discard", tabbed({certificate_columns(record), "CLIENT", "REJECTED"})}};
}

std::string revocation_list_columns(const Record& record)
{
    const Variant* const end = field(record, "NextUpdate");
    return tabbed({clean_text(text_field(record, "FileName"), max_logged_file_name),
                   logged_name(text_field(record, "IssuerName")),
                   utc_text(end == nullptr ? DateTime{} : end->value_or(DateTime{})), "CLIENT",
                   store_text(record, "ListName")});
}

Items log_list_added(const Record& record, DateTime)
{
    return {{"Add_Crl", revocation_list_columns(record)}};
}

Items log_list_removed(const Record& record, DateTime)
{
    return {{"Delete_Crl", revocation_list_columns(record)}};
}

struct LogRule {
    RecordKind kind;
    Items (*items)(const Record&, DateTime now);
};

constexpr std::array log_rules{
    LogRule{RecordKind::ServerStarted, log_started},
    LogRule{RecordKind::ServerPreparing, log_preparing},
    LogRule{RecordKind::ServerRunning, log_running},
    LogRule{RecordKind::ServerShutDown, log_shut_down},
    LogRule{RecordKind::ServerHalted, log_halted},
    LogRule{RecordKind::PublishingLimitExceeded, log_limit},
    LogRule{RecordKind::VariableNotPublished, log_not_published},
    LogRule{RecordKind::VariablesCounted, log_counted},
    LogRule{RecordKind::VariablePublished, log_published},
    LogRule{RecordKind::SessionActivated, log_activated},
    LogRule{RecordKind::SessionRefused, log_application_error},
    LogRule{RecordKind::CertificateRefused, log_application_error},
    LogRule{RecordKind::LoginRefused, log_login_refused},
    LogRule{RecordKind::SessionClosed, log_closed},
    LogRule{RecordKind::SettingsChanged, log_settings},
    LogRule{RecordKind::UsersChanged, log_security_settings},
    LogRule{RecordKind::RolesChanged, log_security_settings},
    LogRule{RecordKind::TrustListUpdated, log_security_settings},
    LogRule{RecordKind::CertificateUpdated, log_own_updated},
    LogRule{RecordKind::CertificateExpiring, log_expiring},
    LogRule{RecordKind::CertificateExpired, log_expired},
    LogRule{RecordKind::CertificateHostNotNamed, log_mismatch},
    LogRule{RecordKind::CertificateAdded, log_added},
    LogRule{RecordKind::CertificateRemoved, log_removed},
    LogRule{RecordKind::CertificateMoved, log_moved},
    LogRule{RecordKind::CertificateDiscarded, log_discarded},
    LogRule{RecordKind::RevocationListAdded, log_list_added},
    LogRule{RecordKind::RevocationListRemoved, log_list_removed},
};

const LogRule* log_rule_of(RecordKind kind)
{
    const auto found = std::find_if(log_rules.begin(), log_rules.end(),
                                    [&](const LogRule& rule) { return rule.kind == kind; });
    return found == log_rules.end() ? nullptr : &*found;
}

} // namespace

bool has_log_rule(RecordKind kind)
{
    return log_rule_of(kind) != nullptr;
}

std::vector<LogDetails> log_details(const Record& record, DateTime now)
{
    const LogRule* const rule = log_rule_of(record.kind);
    return rule == nullptr ? Items{} : rule->items(record, now);
}

} // namespace busbar::controller::detail
