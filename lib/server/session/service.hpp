#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/types/common.hpp>

#include "named_nodes.hpp"
#include "operand_text.hpp"
#include "peer.hpp"
#include "return_diagnostics.hpp"

/// The interface of services; `dispatch.cpp` has the table of them.
///
/// A service that always answers at once is a function
///     StatusCode add_nodes(const NodeManagementNeeds&, ServiceContext&, const AddNodesRequest&,
///                          AddNodesResponse&);
/// whose bad status becomes a ServiceFault; dispatch fills the response header. The first argument
/// is what the service set needs of the server, the second is the caller. A service that may have
/// to wait is an Operation, constructed with its needs. Requests are decoded with Strings::Borrow:
/// their strings point into the message, and copies of them own their memory.
namespace busbar::server::detail {

class Session;

/// The caller.
struct ServiceContext {
    /// The connection that the request came by.
    Peer& peer;
    /// Null for the services that need no session.
    Session* session;
    TimePoint now;
    /// The mark of the request; empty in later turns.
    RequestMark mark{};
};

/// One request whose answer may come later. Owns the message it was decoded from.
///
/// Lives on the server's thread. Other code may answer for it (timeout, Cancel, end of the session)
/// or destroy it unanswered (end of the connection); later answers are dropped, and everything that
/// it waits for must stop referring to it when it is destroyed. That never happens within one of
/// its own members.
class ServiceOperation {
public:
    ServiceOperation() = default;
    ServiceOperation(const ServiceOperation&) = delete;
    ServiceOperation& operator=(const ServiceOperation&) = delete;
    virtual ~ServiceOperation() = default;

    /// Begins, once. It answers by respond() or fault(), exactly once, from here or from later
    /// calls. `context` is invalid after the return. The session may be destroyed once session() is
    /// null.
    virtual void start(ServiceContext& context) = 0;
    /// The time at which the operation wants to be called; dispatch handles the client's own
    /// timeout.
    [[nodiscard]] virtual TimePoint next_deadline() const { return no_deadline; }
    virtual void handle_deadline(TimePoint) {}
    /// True if it has more to do than one turn of its connection allows, and nothing to wait for.
    [[nodiscard]] virtual bool wants_turn() const { return false; }
    /// Continues as far as the connection's Turn allows.
    virtual void take_turn(ServiceContext&) {}
    /// True if it continues while the server shuts down.
    [[nodiscard]] virtual bool outlasts_shutdown() const { return false; }

    [[nodiscard]] bool is_finished() const { return peer_ == nullptr; }
    /// True if the client no longer waits for it.
    [[nodiscard]] bool is_overdue(TimePoint now) const { return client_deadline_ <= now; }
    [[nodiscard]] Session* session() const { return session_; }
    [[nodiscard]] bool is_of(const Peer& peer) const { return peer_ == &peer; }
    [[nodiscard]] std::uint32_t request_id() const { return request_id_; }
    [[nodiscard]] std::uint32_t request_handle() const { return request_handle_; }
    [[nodiscard]] TimePoint client_deadline() const { return client_deadline_; }
    void fault(StatusCode status);

    // Called by the code that executes it.

    /// Takes the message, whose parameters begin at `offset`, and decodes it with memory that
    /// `memory` keeps, if that is not null; Bad_DecodingError, or another reason why it is not such
    /// a request.
    [[nodiscard]] StatusCode decode(std::vector<std::byte> message, std::size_t offset,
                                    const binary::TypeRegistry& types,
                                    const binary::DecodeLimits& limits,
                                    busbar::detail::KeptMemory* memory = nullptr);
    /// Sets the destination of the answer; before start().
    void open(const Question& question, ServiceContext& context);
    /// Replaces the session's aliases by the NodeIds of their nodes, unless the service accepts
    /// them: records and stored data need NodeIds (Part 4, 5.9.5.1). False if the session cannot
    /// pay for them. Call it once, before start().
    [[nodiscard]] bool replace_aliases();
    /// Charges the session for the message and its decoded form; an operation that has not answered
    /// after start() still needs both.
    [[nodiscard]] bool charge_message() { return charge(message_.capacity() + decoded_); }
    /// Drops the operation, whose connection has ended.
    void drop();
    /// Called before the operation is destroyed: returns the message for another use, empty if an
    /// object that outlives the operation needs it.
    [[nodiscard]] virtual std::vector<std::byte> spare_message() { return take_message(); }

protected:
    /// Sends the response: `encode` writes what follows its ResponseHeader. If that does not fit
    /// the client's limits a ServiceFault is sent instead.
    template <typename Response>
    void respond(FunctionRef<void(binary::Writer&)> encode)
    {
        respond(Response::binary_encoding_id, encode, nullptr);
    }
    /// Sends likewise with another serviceResult than Good, of its severity.
    template <typename Response>
    void respond_with(StatusCode result, FunctionRef<void(binary::Writer&)> encode)
    {
        respond(Response::binary_encoding_id, encode, nullptr, result);
    }
    /// Sends likewise with the diagnostics of its operations.
    template <typename Response>
    void respond(const ReturnDiagnostics& diagnostics, FunctionRef<void(binary::Writer&)> encode)
    {
        respond(Response::binary_encoding_id, encode, &diagnostics);
    }
    [[nodiscard]] ReturnDiagnostics diagnostics() const
    {
        return ReturnDiagnostics{return_diagnostics_};
    }
    /// Call it when next_deadline() has become earlier, other than in start() and
    /// handle_deadline(), so that the driver of the connection learns it.
    void deadline_changed();
    /// Charges the session for the memory of the operation while it waits, until it has answered;
    /// false if the session has not that much left. dispatch charges for the message itself.
    [[nodiscard]] bool charge(std::size_t bytes);
    /// Keeps the memory of large lists; may be null.
    [[nodiscard]] busbar::detail::KeptMemory* kept_memory() const { return memory_; }
    /// Maximum size of a response that fits the client's limits.
    [[nodiscard]] std::size_t response_limit() const;
    /// Overwrites the message, and what the request borrows from it.
    void wipe_message() { crypto::cleanse(message_); }
    /// Returns the message, which the request borrows from, for objects that outlive the operation.
    [[nodiscard]] std::vector<std::byte> take_message() { return std::move(message_); }

private:
    virtual void decode_request(binary::Reader& reader) = 0;
    /// Called before the operation ends other than by respond(): by its own fault() or by that of
    /// other code, or with its connection. session() is still there.
    virtual void ends_with(StatusCode /*status*/) {}
    /// True if it looks aliases up by itself, and keeps none.
    [[nodiscard]] virtual bool takes_aliases() const { return false; }
    /// Calls `visit` for each NodeId that may be an alias until it returns false, and returns the
    /// last result.
    [[nodiscard]] virtual bool visit_node_ids(FunctionRef<bool(NodeId&)> visit) = 0;
    void respond(std::uint32_t encoding_id, FunctionRef<void(binary::Writer&)> encode,
                 const ReturnDiagnostics* diagnostics, StatusCode result = {});
    /// Drops peer and session; returns the peer.
    Peer& finish();

    std::vector<std::byte> message_;
    busbar::detail::KeptMemory* memory_{nullptr};
    /// Bytes of the request's objects.
    std::size_t decoded_{0};
    Peer* peer_{nullptr};
    Session* session_{nullptr};
    /// Encoding id of the request's type.
    std::uint32_t encoding_id_{0};
    std::uint32_t request_id_{0};
    std::uint32_t request_handle_{0};
    std::uint32_t return_diagnostics_{0};
    TimePoint client_deadline_{no_deadline};
    std::size_t charged_{0};
};

/// An Operation with its request, whose header is left empty.
template <typename Request>
class OperationOf : public ServiceOperation {
protected:
    [[nodiscard]] const Request& request() const { return request_; }
    [[nodiscard]] Request take_request() { return std::move(request_); }
    /// Sends `results` and the diagnostics of each.
    template <typename Response>
    void respond_results(Response& response)
    {
        ReturnDiagnostics diagnostics = this->diagnostics();
        diagnose(diagnostics, request_, response);
        this->template respond<Response>(diagnostics, [&](binary::Writer& writer) {
            encode(writer, response.results);
            encode(writer, response.diagnostic_infos);
        });
    }

private:
    void decode_request(binary::Reader& reader) final { decode_parameters(reader, request_); }
    [[nodiscard]] bool visit_node_ids(FunctionRef<bool(NodeId&)> visit) final
    {
        return detail::visit_node_ids(request_, visit);
    }

    Request request_;
};

} // namespace busbar::server::detail
