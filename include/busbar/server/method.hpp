#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/array.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/variant.hpp>
#include <busbar/server/access_control.hpp>

/// Methods and the code that carries them out (Part 4, 5.12.2): a Method's node names a DataSource
/// and a handle, as a Variable's does (model::NewMethod, AddressSpace::bind), and DataSource::call
/// gets the calls that one Call service has for that source. `method_table.hpp` is a source made of
/// functions.
namespace busbar::server {

namespace detail {
class CallPart;
struct ResultMark;
} // namespace detail

/// The caller of a Method.
struct MethodCaller {
    NodeId session_id;
    UserIdentity user;
    /// The security mode of the channel.
    MessageSecurityMode security_mode{MessageSecurityMode::None};
    std::string address{};
    std::string audit_entry_id{};
    DateTime action_time{}; // from the request's header
};

/// One Method to carry out.
struct CallItem {
    /// The backend's handle of the Method, set when its node was created.
    std::uint64_t handle{0};
    /// The ids in the request: the Object or ObjectType, and its Method or that of its type. Never
    /// null.
    const NodeId* object_id{nullptr};
    const NodeId* method_id{nullptr};
    /// One for each of the Method's InputArguments, with its data type, value rank and dimensions:
    /// only ranges remain to be checked. Copies of them own their memory.
    std::span<const Variant> inputs;
    /// Set by MethodCall when it has the result, which an audit tells also if the client has left
    /// before the batch is complete. May be null.
    detail::ResultMark* mark{nullptr};
};

/// The result of one Method.
struct CallResult {
    CallResult() = default;
    explicit CallResult(StatusCode code) : status{code} {}

    /// Any severity; Good has no sub code on the wire (Part 4, 5.12.2.4).
    StatusCode status{status::Bad_InternalError};
    /// With Bad_InvalidArgument one for each input, such as Bad_OutOfRange; otherwise not sent.
    Array<StatusCode> input_results;
    /// The reason of a bad status, without secrets: additionalInfo for administrators (Part 4,
    /// 7.12) and the Message of the audit event, both sent with encryption only.
    std::string reason{};
    /// The values of the Method's OutputArguments, in their order, unless `status` is bad. Others
    /// than these answer Bad_InternalError and are logged. They must own their memory.
    Array<Variant> outputs;
};

/// The Methods that one Call service has for one source. They are answered together: a slow Method
/// should have a source of its own.
///
/// Like ReadBatch in ownership, completion and threads: items and caller are valid until the batch
/// is completed or destroyed, once, on any thread, even when client, session and server are gone. A
/// result that was never set answers Bad_InternalError. A Method that has begun is not undone when
/// the client gives up (Part 4, 5.12.2.1).
class BUSBAR_API CallBatch {
public:
    explicit CallBatch(detail::CallPart& part);
    CallBatch(CallBatch&& other) noexcept
        : part_{std::exchange(other.part_, nullptr)}, items_{std::exchange(other.items_, {})},
          results_{std::exchange(other.results_, nullptr)}, caller_{other.caller_}
    {
    }
    CallBatch& operator=(CallBatch&& other) noexcept;
    ~CallBatch() { complete(); }

    [[nodiscard]] std::size_t size() const { return items_.size(); }
    [[nodiscard]] std::span<const CallItem> items() const { return items_; }
    /// One for each item, in the same order.
    [[nodiscard]] std::span<CallResult> results() { return {results_, items_.size()}; }
    [[nodiscard]] const MethodCaller& caller() const { return *caller_; }

    /// True once the results are not needed any more: timeoutHint (Part 4, 7.32), Cancel, end of
    /// the session. A Method that has not begun then should not begin. Called from any thread.
    [[nodiscard]] bool is_abandoned() const;
    /// Hands the results to the server. The batch is empty afterwards; more calls do nothing.
    void complete();
    /// Completes with `status`, which must be bad, for each item.
    void fail(StatusCode status);

private:
    friend class MethodTable;

    /// The server's log; only while DataSource::call runs.
    [[nodiscard]] LogSink& log() const;

    detail::CallPart* part_;
    std::span<const CallItem> items_;
    CallResult* results_;
    const MethodCaller* caller_;
};

} // namespace busbar::server
