#include "machine_event_rules.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <busbar/core/status_codes.hpp>

#include "log_text.hpp"

namespace busbar::controller::detail {

namespace {

using Attached = std::vector<std::string>;

struct Told {
    std::uint32_t code;
    Attached attached{};
};
using AllTold = std::vector<Told>;

constexpr std::uint32_t configuration_refused = 4;
constexpr std::uint32_t log_save_failed = 0x15000000;
constexpr std::uint32_t setting_error = 0x35D00000;
constexpr std::uint32_t medium_worn = 5;
constexpr std::uint32_t certificate_expired = 0x35D10000;
constexpr std::uint32_t expiration_notice = 0x35D20000;
constexpr std::uint32_t unsupported_type = 0x35D40000;
constexpr std::uint32_t system_error = 0x44180000;
constexpr std::uint32_t connection_rejected = 0x85600000;

std::string hex_text(std::uint64_t number, std::size_t width)
{
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string text;
    for (; number != 0; number >>= 4U) {
        text.insert(text.begin(), digits[number & 15U]);
    }
    return std::string(width - std::min(width, text.size()), '0') + text;
}

std::string attached_text(std::string_view text)
{
    return clean_text(text, max_logged_name);
}

/// "YYYY-MM-DD HH:MM:SS", in UTC like the log.
std::string end_of_certificate(const Record& record)
{
    const auto facts = facts_of(record.certificate);
    std::string text = facts ? utc_text(facts->valid_to) : "";
    if (!text.empty()) {
        text.pop_back();
        std::replace(text.begin(), text.end(), 'T', ' ');
    }
    return text;
}

std::string address_of_certificate(const Record& record)
{
    const auto facts = facts_of(record.certificate);
    return facts ? attached_text(facts->first_host) : "";
}

AllTold told_lost(const Record& record, DateTime)
{
    return {{log_save_failed, {hex_text(number_field(record, "Code"), 4)}}};
}

AllTold told_mismatch(const Record& record, DateTime)
{
    return {{0x15020000, {address_of_certificate(record)}}};
}

AllTold told_halted(const Record& record, DateTime)
{
    const bool is_fatal = text_field(record, "Reason") == "OPC UA System Error";
    return {{is_fatal ? system_error : setting_error}};
}

AllTold told_expired(const Record& record, DateTime)
{
    if (text_field(record, "ListName").empty()) {
        return {{certificate_expired, {end_of_certificate(record)}}};
    }
    const auto facts = facts_of(record.certificate);
    return {{0, {facts ? attached_text(facts->common_name) : "", end_of_certificate(record)}}};
}

AllTold told_expiring(const Record& record, DateTime now)
{
    const auto facts = facts_of(record.certificate);
    // This kind also reports a certificate that is not valid yet, which is not an event.
    return facts && now < facts->valid_from
               ? AllTold{}
               : AllTold{{expiration_notice, {end_of_certificate(record)}}};
}

AllTold told_limit(const Record& record, DateTime)
{
    const std::string_view limit = text_field(record, "Limit");
    return limit == "MaxVariables"   ? AllTold{{0x35D30000}}
           : limit == "MaxValues"    ? AllTold{{0x35D50000}}
           : limit == "MaxDataTypes" ? AllTold{{0x35D60000}}
                                     : AllTold{};
}

AllTold told_system_error(const Record&, DateTime)
{
    return {{system_error}};
}

/// Attached information 1 is the reason; 2 is the user name if the user was refused.
AllTold told_login_refused(const Record& record, DateTime)
{
    if (record.status == status::Bad_ApplicationSignatureInvalid) {
        return {{connection_rejected, {"02"}}};
    }
    const std::string_view user = record.actor.user;
    return {{connection_rejected, {"01", user.empty() ? "Anonymous" : attached_text(user)}}};
}

AllTold told_certificate_refused(const Record&, DateTime)
{
    return {{connection_rejected, {"02"}}};
}

AllTold told_session_refused(const Record& record, DateTime)
{
    // The manual has no code for other reasons.
    return record.status == status::Bad_TooManySessions ? AllTold{{connection_rejected, {"04"}}}
                                                        : AllTold{};
}

AllTold told_started(const Record&, DateTime)
{
    return {{0x95D00000}};
}

AllTold told_stopped(const Record&, DateTime)
{
    return {{0x95D10000}};
}

AllTold told_generated(const Record& record, DateTime)
{
    return record.status.is_bad() ? AllTold{} : AllTold{{0x95D20000}};
}

AllTold told_discarded(const Record& record, DateTime)
{
    return {{0x95D30000, {address_of_certificate(record)}}};
}

AllTold told_cleared(const Record&, DateTime)
{
    return {{0x95D40000}};
}

AllTold told_instruction(const Record& record, DateTime)
{
    const auto error = static_cast<std::uint32_t>(number_field(record, "Code") & 0xFFFFU);
    Attached attached{attached_text(text_field(record, "Location")),
                      std::to_string(number_field(record, "Line")),
                      attached_text(text_field(record, "Instance"))};
    if (error != 0x5000) {
        attached.push_back("00000000"); // ErrorIDEx, which the instruction does not have
    }
    return {{0x54010000 + error, std::move(attached)}};
}

AllTold told_fault(const Record& record, DateTime)
{
    const std::string_view level = text_field(record, "Level");
    const std::uint32_t code = level == name(EventLevel::MajorFault)     ? 1
                               : level == name(EventLevel::PartialFault) ? 2
                               : level == name(EventLevel::Observation)  ? medium_worn
                                                                         : 3;
    return {{code, {attached_text(text_field(record, "Where"))}}};
}

AllTold told_refused(const Record& record, DateTime)
{
    return record.status.is_bad()
               ? AllTold{{configuration_refused, {attached_text(text_field(record, "Reason"))}}}
               : AllTold{};
}

/// For records that only end or prepare something.
AllTold told_nothing(const Record&, DateTime)
{
    return {};
}

struct EventRule {
    RecordKind kind;
    AllTold (*told)(const Record&, DateTime now);
};

constexpr std::array event_rules{
    EventRule{RecordKind::ExecutionLogLost, told_lost},
    EventRule{RecordKind::ExecutionLogSaved, told_nothing},
    EventRule{RecordKind::CertificateHostNotNamed, told_mismatch},
    EventRule{RecordKind::CertificateExpired, told_expired},
    EventRule{RecordKind::CertificateExpiring, told_expiring},
    EventRule{RecordKind::CertificateUpdated, told_generated},
    EventRule{RecordKind::CertificateRefused, told_certificate_refused},
    EventRule{RecordKind::CertificateDiscarded, told_discarded},
    EventRule{RecordKind::LoginRefused, told_login_refused},
    EventRule{RecordKind::SessionRefused, told_session_refused},
    EventRule{RecordKind::ServerStarted, told_started},
    EventRule{RecordKind::ServerPreparing, told_nothing},
    EventRule{RecordKind::ServerRunning, told_nothing},
    EventRule{RecordKind::ServerShutDown, told_stopped},
    EventRule{RecordKind::ServerHalted, told_halted},
    EventRule{RecordKind::ServerSystemError, told_system_error},
    EventRule{RecordKind::PublishingLimitExceeded, told_limit},
    EventRule{RecordKind::VariableNotPublished, told_nothing},
    EventRule{RecordKind::VariablesCounted, told_nothing},
    EventRule{RecordKind::SecurityCleared, told_cleared},
    EventRule{RecordKind::InstructionFailed, told_instruction},
    EventRule{RecordKind::MachineFault, told_fault},
    EventRule{RecordKind::ConfigurationRefused, told_refused},
};

const EventRule* event_rule_of(RecordKind kind)
{
    const auto found = std::find_if(event_rules.begin(), event_rules.end(),
                                    [&](const EventRule& rule) { return rule.kind == kind; });
    return found == event_rules.end() ? nullptr : &*found;
}

} // namespace

bool MachineEventRules::wants(RecordKind kind)
{
    return event_rule_of(kind) != nullptr;
}

std::vector<MachineEvent> MachineEventRules::take(const Record& record, DateTime now)
{
    const EventRule* const rule = event_rule_of(record.kind);
    if (rule == nullptr || !once_.is_new(record)) {
        return {};
    }
    end(record);
    AllTold all = rule->told(record, now);
    if (record.kind == RecordKind::VariableNotPublished) {
        note_not_published(record);
    } else if (record.kind == RecordKind::VariablesCounted && not_published_ != 0) {
        // One event for all variables (W588, 9-2-2).
        // The manual has eight bits; a further one is of this controller.
        const std::uint32_t bits = std::exchange(not_published_, 0);
        all.push_back({unsupported_type, {hex_text(bits, bits > 0xFFU ? 4 : 2)}});
    }
    std::vector<MachineEvent> events;
    for (Told& told : all) {
        const MachineEventType* const type = machine_event_type(told.code);
        if (type == nullptr) { // an unknown error of an instruction
            continue;
        }
        MachineEvent event{0, now, type, level_of(*type), std::move(told.attached)};
        if (stands_already(event)) {
            continue;
        }
        if (type->end != EventEnd::Never) {
            end_one(type->code);
            standing_.push_back(event);
            ++changes_;
        }
        events.push_back(std::move(event));
    }
    return events;
}

/// Ends the errors that this record resolves.
void MachineEventRules::end(const Record& record)
{
    switch (record.kind) {
    case RecordKind::ExecutionLogSaved:
        return end_one(log_save_failed);
    case RecordKind::ServerStarted:
        return end_all(EventEnd::Restart);
    case RecordKind::ServerRunning:
        return end_one(setting_error);
    case RecordKind::CertificateUpdated:
        if (!record.status.is_bad()) {
            end_one(certificate_expired);
            end_all(EventEnd::Renewal);
        }
        return;
    case RecordKind::CertificateExpired:
        if (field(record, "ListName") == nullptr) {
            end_one(expiration_notice);
        }
        return;
    case RecordKind::ConfigurationRefused:
        return end_one(configuration_refused);
    case RecordKind::ServerPreparing:
        not_published_ = 0;
        return end_all(EventEnd::Preparation);
    default:
        return;
    }
}

void MachineEventRules::end_all(EventEnd what)
{
    changes_ +=
        std::erase_if(standing_, [&](const MachineEvent& each) { return each.type->end == what; });
}

void MachineEventRules::end_one(std::uint32_t code)
{
    changes_ +=
        std::erase_if(standing_, [&](const MachineEvent& each) { return each.type->code == code; });
}

void MachineEventRules::note_not_published(const Record& record)
{
    not_published_ |= static_cast<unsigned>(number_field(record, "ErrorDetails") & 0xFFFFU);
}

/// Tells whether the same error is already present. Errors that end with a preparation are reported
/// each time: the next one may find them again.
bool MachineEventRules::stands_already(const MachineEvent& event) const
{
    return std::any_of(standing_.begin(), standing_.end(), [&](const MachineEvent& each) {
        return each.type == event.type && each.attached == event.attached &&
               (event.type->end == EventEnd::Automatic || event.type->end == EventEnd::Restart);
    });
}

EventLevel MachineEventRules::level_of(const MachineEventType& type) const
{
    const auto chosen = std::find_if(levels_.begin(), levels_.end(),
                                     [&](const auto& each) { return each.code == type.code; });
    return chosen == levels_.end() ? type.level : chosen->level;
}

} // namespace busbar::controller::detail
