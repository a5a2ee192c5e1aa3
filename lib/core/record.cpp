#include <busbar/core/record.hpp>

#include <algorithm>
#include <array>

namespace busbar {

std::string_view name(RecordKind kind)
{
    constexpr std::array names = {
        "ChannelOpened",
        "ChannelRenewed",
        "ChannelRefused",
        "ChannelClosed",
        "SessionCreated",
        "SessionRefused",
        "UrlMismatch",
        "SessionActivated",
        "LoginRefused",
        "SessionClosed",
        "RequestCancelled",
        "SubscriptionsTransferred",
        "CertificateRefused",
        "CertificateSuppressed",
        "CertificateSaved",
        "CertificateDiscarded",
        "CertificateAdded",
        "CertificateMoved",
        "CertificateRemoved",
        "CertificateUpdated",
        "CertificateExpiring",
        "CertificateExpired",
        "CertificateHostNotNamed",
        "RevocationListAdded",
        "RevocationListRemoved",
        "TrustListUpdated",
        "SettingsChanged",
        "UsersChanged",
        "RolesChanged",
        "AttributeWritten",
        "MethodCalled",
        "NodesAdded",
        "NodesDeleted",
        "ReferencesAdded",
        "ReferencesDeleted",
        "ServerStarted",
        "ServerPreparing",
        "ServerRunning",
        "ServerShutDown",
        "ServerHalted",
        "ServerSystemError",
        "VariablesCounted",
        "VariablePublished",
        "VariableNotPublished",
        "ExecutionLogLost",
        "SecurityCleared",
        "PublishingLimitExceeded",
        "InstructionFailed",
        "ExecutionLogSaved",
        "MachineFault",
        "ConfigurationRefused",
    };
    static_assert(names.size() == static_cast<std::size_t>(RecordKind::ConfigurationRefused) + 1);
    return names[static_cast<std::size_t>(kind)];
}

void tell(LogSink& log, const Record& record)
{
    if (log.wants(record.kind)) {
        log.record(record);
    }
    if (!record.text.empty()) {
        log.write(record.level, record.source, record.text);
    } else if (record.refusal != nullptr) {
        log.write(record.level, record.source, text(*record.refusal));
    }
}

const Variant* field(const Record& record, std::string_view name)
{
    const auto found = std::find_if(record.fields.begin(), record.fields.end(),
                                    [&](const RecordField& one) { return one.name == name; });
    return found == record.fields.end() ? nullptr : &found->value;
}

} // namespace busbar
