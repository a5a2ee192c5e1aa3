#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/core/variant.hpp>

namespace busbar {

/// The kinds of occurrences that may be of interest later. In brackets the fields that a record of
/// the kind has, by their names in the specification's event types.
enum class RecordKind : std::uint8_t {
    ChannelOpened,  // [RequestType, SecurityPolicyUri, SecurityMode, RequestedLifetime]
    ChannelRenewed, // the same
    ChannelRefused, // also a renewal
    ChannelClosed,  // by the client's CloseSecureChannel

    SessionCreated, // [RevisedSessionTimeout, EndpointUrl]
    SessionRefused, // by CreateSession
    /// [EndpointUrl]: the client connects by a name that the server does not have.
    UrlMismatch,
    /// [UserTokenType, IsFirst: false if the session was activated before, UserIdentityToken]; the
    /// token without its secret.
    SessionActivated,
    LoginRefused, // [UserIdentityToken], by ActivateSession
    /// [WasActivated, Cause: "CloseSession", "Timeout" or "Terminated"]; status: why.
    SessionClosed,
    RequestCancelled, // [RequestHandle]
    /// Caused by TransferSubscriptions, to the actor's session; status: the first bad one.
    SubscriptionsTransferred,

    CertificateRefused,
    CertificateSuppressed, // accepted by a setting; the refusal says which errors were suppressed
    CertificateSaved,      // in the rejected list
    CertificateDiscarded,
    CertificateAdded, // [ListName]; the next ones have the same field
    CertificateMoved, // [ListName, FromListName]
    CertificateRemoved,
    CertificateUpdated,  // the application's own; the new one if the update succeeded
    CertificateExpiring, // or not valid yet
    /// The application's own, as for the kinds before and after; with [ListName] one of that list.
    CertificateExpired,
    CertificateHostNotNamed,
    /// [ListName, FileName, IssuerName: its common name, NextUpdate: null if it has none]; the next
    /// one has the same fields.
    RevocationListAdded,
    RevocationListRemoved,
    TrustListUpdated, // [TrustListId], as a whole

    SettingsChanged,
    UsersChanged,
    RolesChanged,

    /// [NodeId, AttributeId, IndexRange, NewValue], one for each node of a Write.
    AttributeWritten,
    MethodCalled,      // [ObjectId, MethodId, InputArguments]
    NodesAdded,        // [NodeId, ParentNodeId], one for each node
    NodesDeleted,      // [NodeId]
    ReferencesAdded,   // [SourceNodeId, ReferenceTypeId, TargetNodeId]
    ReferencesDeleted, // the same

    // The life cycle of a controller's server (W588, 4-2-4), which has no audit
    // events.
    ServerStarted,
    ServerPreparing, // its endpoints and nodes are being created
    ServerRunning,   // [EndpointUrl]
    ServerShutDown,  // completed
    ServerHalted,    // [Reason: "Configuration Error", "Server Start Error", "OPC UA System Error"]
    ServerSystemError,
    VariablesCounted,  // [Variables, Values, DataTypes], the numbers of all that are published
    VariablePublished, // [Name, Size, Values, Members]
    /// [Name, Reason, Size, ErrorDetails]: a rule excludes one variable (manual of variables mode,
    /// 7-1-6, 35D40000).
    VariableNotPublished,
    /// [Code]: 0001, 0002, 0003, 0005 or 0302 (W588, 9-2-2, 15000000).
    ExecutionLogLost,
    /// The own certificate and the trust lists are lost (W588, 9-2-2,
    /// 95D40000).
    SecurityCleared,
    /// [Limit: "MaxVariables", "MaxValues", "MaxDataTypes"]: not everything is published.
    PublishingLimitExceeded,
    /// [Code, Instruction, and if known Location, Line, Instance]: an instruction of the
    /// controller's program failed; the code is a UInt16 followed, after 5401, by the event's code
    /// (W588, 9-2-2).
    InstructionFailed,
    ExecutionLogSaved, // works again, after ExecutionLogLost
    /// [Level: "Major fault", "Partial fault" or "Minor fault", Where: "CPU Unit"]: a fault of the
    /// controller (W588, 9-1-2).
    MachineFault,
    /// [Reason]: a configuration cannot be used, and another one is in force; status Good: it is
    /// used now, or no longer requested.
    ConfigurationRefused,
};

/// "SessionCreated".
[[nodiscard]] BUSBAR_API std::string_view name(RecordKind kind);

/// A value of a record, and its name.
struct RecordField {
    std::string_view name;
    Variant value;
};

/// The user or peer that caused it; members are empty if unknown. Texts come from the peer and have
/// not passed `printable`.
struct RecordActor {
    /// Null if there is no session.
    const NodeId* session_id{nullptr};
    std::string_view session_name{};
    std::string_view application_uri{};
    /// ClientUserId (Part 5, 6.4.3).
    std::string_view user{};
    /// The address without port.
    std::string_view address{};
    /// AuditEntryId of the request's header (Part 4, 7.33).
    std::string_view audit_entry_id{};
    /// The timestamp of the request's header: when the user acted, by the client's clock (Part 5,
    /// 6.4.3). Null if there is no request.
    DateTime action_time{};
    std::uint32_t secure_channel_id{0};
};

/// One occurrence. Never holds a secret. Borrows everything it refers to.
struct Record {
    RecordKind kind{};
    LogLevel level{LogLevel::Info};
    /// The layer or part, as LogSink::write has it.
    std::string_view source{};
    /// A line for people; empty if the refusal says it, or if no line is written.
    std::string text{};
    /// Good if the operation succeeded.
    StatusCode status{};
    /// The reason if it failed; may be null.
    const Refusal* refusal{nullptr};
    RecordActor actor{};
    /// DER of the certificate that it is about: the peer's for a channel or session. Empty if there
    /// is none.
    std::span<const std::byte> certificate{};
    std::span<const RecordField> fields{};
};

/// Passes the record to a sink that wants it, and its line to every sink.
BUSBAR_API void tell(LogSink& log, const Record& record);

/// Returns the value of a field; null if the record has no field of this name.
[[nodiscard]] BUSBAR_API const Variant* field(const Record& record, std::string_view name);

} // namespace busbar
