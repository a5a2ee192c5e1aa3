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

/// What can happen that somebody may have to know of later. In brackets the fields that a record
/// of the kind has, by the names that the specification's event types have for them.
enum class RecordKind : std::uint8_t {
    ChannelOpened,  // [RequestType, SecurityPolicyUri, SecurityMode, RequestedLifetime]
    ChannelRenewed, // the same
    ChannelRefused, // also a renewal
    ChannelClosed,  // by the client's CloseSecureChannel

    SessionCreated, // [RevisedSessionTimeout, EndpointUrl]
    SessionRefused, // by CreateSession
    /// [EndpointUrl]: the client connects by a name that the server does not have.
    UrlMismatch,
    /// [UserTokenType, IsFirst: false if it was activated before, UserIdentityToken]; of a token
    /// all but its secret.
    SessionActivated,
    LoginRefused, // [UserIdentityToken], by ActivateSession
    /// [WasActivated, Cause: "CloseSession", "Timeout" or "Terminated"]; status: why.
    SessionClosed,
    RequestCancelled, // [RequestHandle]
    /// By TransferSubscriptions, to the actor's session; status: the first that is not good.
    SubscriptionsTransferred,

    CertificateRefused,
    CertificateSuppressed, // accepted by a setting; the refusal says what was passed over
    CertificateSaved,      // in rejected
    CertificateDiscarded,
    CertificateAdded, // [ListName]; also for the next ones
    CertificateMoved, // [ListName, FromListName]
    CertificateRemoved,
    CertificateUpdated,  // the application's own; the new one if it was done
    CertificateExpiring, // or not valid yet
    /// The application's own, like the two beside it; with [ListName] one of that list.
    CertificateExpired,
    CertificateHostNotNamed,
    /// [ListName, FileName, IssuerName: its common name, NextUpdate: null if it has none]; also for
    /// the next one.
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

    // The life of a controller's server (seed 000, 4-2-4), which has no audit events.
    ServerStarted,
    ServerPreparing, // its endpoints and nodes are being made
    ServerRunning,   // [EndpointUrl]
    ServerShutDown,  // completed
    ServerHalted,    // [Reason: "Configuration Error", "Server Start Error", "OPC UA System Error"]
    ServerSystemError,
    VariablesCounted,  // [Variables, Values, DataTypes], all that are published
    VariablePublished, // [Name, Size, Values, Members]
    /// [Name, Reason, Size, ErrorDetails]: by a rule for one variable (seed 000, 7-1-6, 35D40000).
    VariableNotPublished,
    /// [Code]: 0001, 0002, 0003, 0005 or 0302 (seed 000, 9-2-2, 15000000).
    ExecutionLogLost,
    /// The certificate and whom the server trusts are gone (seed 000, 9-2-2, 95D40000).
    SecurityCleared,
    /// [Limit: "MaxVariables", "MaxValues", "MaxDataTypes"]: not everything is published.
    PublishingLimitExceeded,
    /// [Code, Instruction, and as far as it is known Location, Line, Instance]: an instruction of
    /// the controller's program failed; the code is UInt16 and, after 5401, the event's code
    /// (seed 000, 9-2-2).
    InstructionFailed,
    ExecutionLogSaved, // again, after ExecutionLogLost
    /// [Level: "Major fault", "Partial fault" or "Minor fault", Where: "CPU Unit"], of the
    /// controller (seed 000, 9-1-2).
    MachineFault,
    /// [Reason]: a configuration cannot be used, and another one is in force; status Good: it is
    /// used, or nobody asks for it any more.
    ConfigurationRefused,
};

/// "SessionCreated".
[[nodiscard]] BUSBAR_API std::string_view name(RecordKind kind);

struct RecordField {
    std::string_view name;
    Variant value;
};

/// Who did it; empty where that is not known. Texts come from the peer and have not been through
/// `printable`.
struct RecordActor {
    /// Null if there is no session.
    const NodeId* session_id{nullptr};
    std::string_view session_name{};
    std::string_view application_uri{};
    /// ClientUserId (Part 5, 6.4.3).
    std::string_view user{};
    /// Without port.
    std::string_view address{};
    /// AuditEntryId of the request's header (Part 4, 7.33).
    std::string_view audit_entry_id{};
    /// The timestamp of the request's header: when the user acted, by the client's clock (Part 5,
    /// 6.4.3). Null if there is no request.
    DateTime action_time{};
    std::uint32_t secure_channel_id{0};
};

/// One thing that happened. Never holds a secret. Borrows all that it refers to.
struct Record {
    RecordKind kind{};
    LogLevel level{LogLevel::Info};
    /// The layer or part, as LogSink::write has it.
    std::string_view source{};
    /// For people, in one line; empty: the refusal says it, or no line is written.
    std::string text{};
    /// Good if it was done.
    StatusCode status{};
    /// Why it was not done; may be null.
    const Refusal* refusal{nullptr};
    RecordActor actor{};
    /// DER of the certificate that it is about: the peer's of a channel or session. Empty if there
    /// is none.
    std::span<const std::byte> certificate{};
    std::span<const RecordField> fields{};
};

/// The record for a sink that wants it, and its line for every sink.
BUSBAR_API void tell(LogSink& log, const Record& record);

/// The field's value; null if there is none of this name.
[[nodiscard]] BUSBAR_API const Variant* field(const Record& record, std::string_view name);

} // namespace busbar
