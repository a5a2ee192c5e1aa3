#include <busbar/administration/audit_log.hpp>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include <busbar/core/status_codes.hpp>
#include <busbar/crypto/certificate.hpp>

namespace busbar::administration {

namespace {

using server::Event;

constexpr std::uint16_t severity_of_success = 100;
constexpr std::uint16_t severity_of_failure = 600;

/// The event for a kind of record, in the order of RecordKind. Without an event type there is no
/// event, nor for kinds after the last row.
struct Row {
    std::uint32_t event_type;
    std::string_view source_name;
};

constexpr std::array rows{
    Row{id::AuditOpenSecureChannelEventType, "SecureChannel/OpenSecureChannel"}, // ChannelOpened
    Row{0, {}}, // ChannelRenewed: only if it fails (Part 4, 6.5.5)
    Row{id::AuditOpenSecureChannelEventType, "SecureChannel/OpenSecureChannel"}, // ChannelRefused
    Row{id::AuditChannelEventType, "SecureChannel/CloseSecureChannel"},          // ChannelClosed
    Row{id::AuditCreateSessionEventType, "Session/CreateSession"},               // SessionCreated
    Row{id::AuditCreateSessionEventType, "Session/CreateSession"},               // SessionRefused
    Row{id::AuditUrlMismatchEventType, "Session/CreateSession"},                 // UrlMismatch
    Row{id::AuditActivateSessionEventType, "Session/ActivateSession"},           // SessionActivated
    Row{id::AuditActivateSessionEventType, "Session/ActivateSession"},           // LoginRefused
    Row{id::AuditSessionEventType, "Session/CloseSession"},                      // SessionClosed
    Row{id::AuditCancelEventType, "Session/Cancel"},                             // RequestCancelled
    Row{id::AuditSessionEventType, "Session/TransferSubscriptions"},   // SubscriptionsTransferred
    Row{id::AuditCertificateEventType, "Security/Certificate"},        // CertificateRefused
    Row{id::AuditCertificateEventType, "Security/Certificate"},        // CertificateSuppressed
    Row{0, {}},                                                        // CertificateSaved
    Row{0, {}},                                                        // CertificateDiscarded
    Row{id::TrustListUpdatedAuditEventType, "Security/TrustList"},     // CertificateAdded
    Row{id::TrustListUpdatedAuditEventType, "Security/TrustList"},     // CertificateMoved
    Row{id::TrustListUpdatedAuditEventType, "Security/TrustList"},     // CertificateRemoved
    Row{id::CertificateUpdatedAuditEventType, "Security/Certificate"}, // CertificateUpdated
    Row{0, {}},                                                        // CertificateExpiring
    Row{0, {}},                                                        // CertificateExpired
    Row{0, {}},                                                        // CertificateHostNotNamed
    Row{id::TrustListUpdatedAuditEventType, "Security/TrustList"},     // RevocationListAdded
    Row{id::TrustListUpdatedAuditEventType, "Security/TrustList"},     // RevocationListRemoved
    Row{id::TrustListUpdatedAuditEventType, "Security/TrustList"},     // TrustListUpdated
    Row{id::AuditSecurityEventType, "Server/Configuration"},           // SettingsChanged
    Row{id::AuditSecurityEventType, "Server/Users"},                   // UsersChanged
    Row{id::RoleMappingRuleChangedAuditEventType, "Server/RoleSet"},   // RolesChanged
    Row{id::AuditWriteUpdateEventType, "Attribute/Write"},             // AttributeWritten
    Row{id::AuditUpdateMethodEventType, "Attribute/Call"},             // MethodCalled
    Row{id::AuditAddNodesEventType, "NodeManagement/AddNodes"},        // NodesAdded
    Row{id::AuditDeleteNodesEventType, "NodeManagement/DeleteNodes"},  // NodesDeleted
    Row{id::AuditAddReferencesEventType, "NodeManagement/AddReferences"},
    Row{id::AuditDeleteReferencesEventType, "NodeManagement/DeleteReferences"},
};
static_assert(rows.size() == static_cast<std::size_t>(RecordKind::ServerStarted));

const Row& row_of(RecordKind kind)
{
    static constexpr Row none{0, {}};
    const auto place = static_cast<std::size_t>(kind);
    return place < rows.size() ? rows[place] : none;
}

bool is_in(std::span<const std::uint32_t> ids, const NodeId& id)
{
    return std::any_of(ids.begin(), ids.end(), [&](std::uint32_t each) { return id.is(each); });
}

NodeId node_of(const Record& record, std::string_view name)
{
    const Variant* const value = field(record, name);
    return value != nullptr ? value->value_or<NodeId>({}) : NodeId{};
}

/// All Methods of a role add or remove a part of its mapping rules.
bool is_role(const NodeId& object)
{
    static constexpr std::array roles{
        id::WellKnownRole_Anonymous,          id::WellKnownRole_AuthenticatedUser,
        id::WellKnownRole_TrustedApplication, id::WellKnownRole_Observer,
        id::WellKnownRole_Operator,           id::WellKnownRole_Supervisor,
        id::WellKnownRole_Engineer,           id::WellKnownRole_ConfigureAdmin,
        id::WellKnownRole_SecurityAdmin};
    return is_in(roles, object) ||
           (object.namespace_index() == 1 && object.id_type() == IdType::String &&
            object.string().view().starts_with("RoleSet/"));
}

/// CloseAndUpdate, AddCertificate or RemoveCertificate of TrustListType, or of a group's trust
/// list: applications, https, users.
bool changes_trust_list(const NodeId& method)
{
    static constexpr std::array<std::uint32_t, 12> methods{
        12546, 12548, 12550, 12666, 12668, 12670, 14114, 14117, 14119, 14148, 14151, 14153};
    return is_in(methods, method);
}

/// Returns the type of a Method's event, AuditUpdateMethodEventType or a subtype of it: each Method
/// has one event (Part 4, 6.5.9; Part 5, 6.4.27).
std::uint32_t method_type(const Record& record)
{
    const NodeId method = node_of(record, "MethodId");
    if (is_in(std::array{id::ServerConfiguration_UpdateCertificate,
                         id::ServerConfigurationType_UpdateCertificate},
              method)) {
        return id::CertificateUpdateRequestedAuditEventType; // Part 12, 7.10.26
    }
    if (changes_trust_list(method)) {
        return id::TrustListUpdateRequestedAuditEventType; // Part 12, 7.8.2.12
    }
    // Only if it has updated the role (Part 18, 4.5).
    return !record.status.is_bad() && is_role(node_of(record, "ObjectId"))
               ? id::RoleMappingRuleChangedAuditEventType
               : id::AuditUpdateMethodEventType;
}

/// True for what a Method has done or been refused, whose own event tells that: another event has
/// only what was changed as a whole (Part 12, 7.8.2.13 and 7.10.27).
bool is_told_otherwise(const Record& record)
{
    if (field(record, "MethodId") == nullptr) {
        return false;
    }
    switch (record.kind) {
    case RecordKind::SettingsChanged:
    case RecordKind::UsersChanged:
    case RecordKind::RolesChanged:
        return true;
    case RecordKind::TrustListUpdated:
    case RecordKind::CertificateUpdated:
        return record.status.is_bad();
    default:
        return false;
    }
}

/// Returns the event type for what is wrong with the certificate (Part 5, 6.4.13 to 6.4.18).
std::uint32_t certificate_type(StatusCode status)
{
    struct Reason {
        StatusCode status;
        std::uint32_t event_type;
    };
    static constexpr std::array reasons{
        Reason{status::Bad_CertificateTimeInvalid, id::AuditCertificateExpiredEventType},
        Reason{status::Bad_CertificateIssuerTimeInvalid, id::AuditCertificateExpiredEventType},
        Reason{status::Bad_CertificateUntrusted, id::AuditCertificateUntrustedEventType},
        Reason{status::Bad_CertificateChainIncomplete, id::AuditCertificateUntrustedEventType},
        Reason{status::Bad_CertificateRevoked, id::AuditCertificateRevokedEventType},
        Reason{status::Bad_CertificateIssuerRevoked, id::AuditCertificateRevokedEventType},
        Reason{status::Bad_CertificateUseNotAllowed, id::AuditCertificateMismatchEventType},
        Reason{status::Bad_CertificateIssuerUseNotAllowed, id::AuditCertificateMismatchEventType},
        Reason{status::Bad_CertificateHostNameInvalid, id::AuditCertificateDataMismatchEventType},
        Reason{status::Bad_CertificateUriInvalid, id::AuditCertificateDataMismatchEventType},
    };
    for (const Reason& reason : reasons) {
        if (reason.status == status) {
            return reason.event_type;
        }
    }
    return id::AuditCertificateInvalidEventType;
}

bool is_of_certificate(RecordKind kind)
{
    return kind == RecordKind::CertificateRefused || kind == RecordKind::CertificateSuppressed;
}

/// Tells whether a field has another name or place in events, or is left out.
bool is_renamed(std::string_view name)
{
    static constexpr std::array<std::string_view, 11> names{
        "Cause",   "NodeId",       "ObjectId", "ListName",   "FromListName", "UserTokenType",
        "IsFirst", "WasActivated", "FileName", "IssuerName", "NextUpdate"};
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// Returns the SourceName; for a session it tells what ended it, "Session/Timeout" (Part 4, 6.5.6).
String source_name(const Record& record, std::string_view usual)
{
    const Variant* const cause =
        record.kind == RecordKind::SessionClosed ? field(record, "Cause") : nullptr;
    const auto* const text = cause != nullptr ? cause->get_if<String>() : nullptr;
    return String{text != nullptr ? "Session/" + text->str() : std::string{usual}};
}

/// Returns the user name for records made before a login (Part 5, 6.4.5, 6.4.6 and 6.4.8).
std::string_view user_of_system(RecordKind kind)
{
    switch (kind) {
    case RecordKind::ChannelOpened:
    case RecordKind::ChannelRefused:
        return "System/OpenSecureChannel";
    case RecordKind::ChannelClosed:
        return "System/CloseSecureChannel";
    case RecordKind::SessionCreated:
    case RecordKind::SessionRefused:
    case RecordKind::UrlMismatch:
        return "System/CreateSession";
    default:
        return {};
    }
}

void set_text(Event& event, const char* name, std::string_view text)
{
    event.set({0, name}, Variant{String{std::string{text}}});
}

void set_actor(Event& event, const Record& record)
{
    const RecordActor& actor = record.actor;
    set_text(event, "ClientAuditEntryId", actor.audit_entry_id);
    set_text(event, "ClientUserId", actor.user.empty() ? user_of_system(record.kind) : actor.user);
    if (!actor.application_uri.empty()) {
        set_text(event, "ClientApplicationUri", actor.application_uri);
    }
    if (actor.session_id != nullptr) {
        event.set({0, "SessionId"}, Variant{*actor.session_id});
    }
    if (actor.secure_channel_id != 0) {
        set_text(event, "SecureChannelId", std::to_string(actor.secure_channel_id));
    }
}

void set_certificate(Event& event, const Record& record)
{
    // A new certificate does not belong to the client (Part 12, 7.10.14).
    if (record.certificate.empty() || record.kind == RecordKind::CertificateUpdated) {
        return;
    }
    const Variant der{ByteString{record.certificate}};
    event.set({0, is_of_certificate(record.kind) ? "Certificate" : "ClientCertificate"}, der);
    if (const auto certificate = crypto::Certificate::parse(record.certificate)) {
        set_text(event, "ClientCertificateThumbprint", certificate->thumbprint_text());
    }
}

} // namespace

Event audit_event(const Record& record, std::string_view server_id)
{
    const Row& row = row_of(record.kind);
    const bool is_done = !record.status.is_bad() || record.kind == RecordKind::SessionClosed;
    Event event;
    event.event_type = NodeId{0, is_of_certificate(record.kind) ? certificate_type(record.status)
                                 : record.kind == RecordKind::MethodCalled ? method_type(record)
                                                                           : row.event_type};
    event.source_name = source_name(record, row.source_name);
    event.message = LocalizedText{
        "en", String{record.text.empty() ? std::string{name(record.kind)} : record.text}};
    event.severity = is_done ? severity_of_success : severity_of_failure;
    event.set({0, "ActionTimeStamp"}, Variant{record.actor.action_time});
    event.set({0, "Status"}, Variant{is_done});
    event.set({0, "StatusCodeId"}, Variant{record.status});
    set_text(event, "ServerId", server_id);
    set_actor(event, record);
    set_certificate(event, record);
    for (const RecordField& field : record.fields) {
        if (!is_renamed(field.name)) {
            event.set({0, String{std::string{field.name}}}, field.value);
        }
    }
    const NodeId node =
        node_of(record, record.kind == RecordKind::AttributeWritten ? "NodeId" : "ObjectId");
    if (!node.is_null()) {
        event.source_node = node;
    }
    return event;
}

void AuditLog::attach(std::shared_ptr<server::EventQueue> queue, std::string server_id)
{
    queue_ = std::move(queue);
    server_id_ = std::move(server_id);
}

bool AuditLog::wants(RecordKind kind) const
{
    return lines_->wants(kind) || (queue_ != nullptr && row_of(kind).event_type != 0);
}

void AuditLog::record(const Record& record)
{
    if (lines_->wants(record.kind)) {
        lines_->record(record);
    }
    const bool is_told = is_told_otherwise(record) ||
                         (record.kind == RecordKind::SettingsChanged && is_changing_settings_);
    if (queue_ != nullptr && row_of(record.kind).event_type != 0 && !is_told) {
        // The queue counts events that it has no room for.
        static_cast<void>(queue_->raise(audit_event(record, server_id_)));
    }
}

} // namespace busbar::administration
