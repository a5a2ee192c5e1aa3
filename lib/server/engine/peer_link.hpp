#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/channel/server_channel.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/server/connection.hpp>

#include "channel_work.hpp"
#include "core.hpp"
#include "server/session/service.hpp"
#include "server/session/turn.hpp"

namespace busbar::server::detail {

/// The server's log with the peer's address before each line and in each record; rationed like
/// Core::log.
class PeerLog final : public LogSink {
public:
    PeerLog(Core& core, std::string_view address) : core_{core}, address_{address} {}

    void write(LogLevel level, std::string_view source, std::string_view text) override;
    void record(const Record& record) override;
    [[nodiscard]] bool wants(RecordKind kind) const override;

private:
    Core& core_;
    std::string_view address_;
};

/// The implementation of a Connection: its channel and the operations that wait on it.
class PeerLink final : public Peer {
public:
    /// Adds itself to `core`.
    PeerLink(Core& core, std::string_view peer_address, TimePoint now);
    ~PeerLink();

    // The engine, see Connection.

    [[nodiscard]] std::uint64_t id() const { return id_; }
    [[nodiscard]] Core& core() { return core_; }
    [[nodiscard]] Result<void> reverse_hello(std::string_view endpoint_url);
    void came_by(std::uint32_t listener) { listener_ = listener; }
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    [[nodiscard]] bool has_enough() const
    {
        return (has_more_ || channel_.is_waiting()) && !is_closed();
    }
    [[nodiscard]] std::optional<ConnectionEvent> next_event();
    [[nodiscard]] std::span<const std::byte> output() const;
    void consume(std::size_t size);
    [[nodiscard]] TimePoint next_deadline() const;
    void handle_deadline(TimePoint now);
    [[nodiscard]] bool is_closed() const { return channel_.is_closed(); }
    /// Answers everything that does not outlast the shutdown with Bad_Shutdown.
    void begin_shutdown();

    // Peer.

    [[nodiscard]] const channel::ServerChannel& channel() const override { return channel_; }
    [[nodiscard]] std::string_view address() const override { return peer_address_; }
    [[nodiscard]] std::uint32_t listener() const override { return listener_; }
    [[nodiscard]] const std::vector<Session*>& sessions() const override { return sessions_; }
    void bind(Session& session) override;
    void unbind(Session& session) override;
    void end_operations(const Session& session, StatusCode status) override;
    [[nodiscard]] Turn& turn() override { return turn_; }
    [[nodiscard]] bool has_thrown() const override;
    [[nodiscard]] LogSink& log() override { return log_; }

    // Outbox.

    void respond(const Reply& reply, std::uint32_t encoding_id,
                 FunctionRef<void(binary::Writer&)> encode_response) override;
    void fault(const Reply& reply, StatusCode status) override;
    [[nodiscard]] ResponseHeader response_header(const Reply& reply,
                                                 StatusCode status) const override;
    [[nodiscard]] std::size_t max_response_size() const override
    {
        return channel_.max_response_size();
    }
    void count_fault(Session* session, std::uint32_t encoding_id, StatusCode status) override;
    void mark() override;
    void wants_sweep() override;

    // Used by dispatch.

    [[nodiscard]] bool has_place_for_operation() const;
    /// Answers the request with the exception's status if `service` throws, unless it was answered
    /// before.
    void serve(const Reply& reply, FunctionRef<void()> service);
    /// Frees the memory of a message that is not needed any more.
    void recycle(std::vector<std::byte> message) { channel_.recycle(std::move(message)); }
    /// Takes the operation with its message, decodes the parameters that begin at `offset` and
    /// starts it.
    void start(std::unique_ptr<ServiceOperation> operation, std::vector<std::byte> message,
               std::size_t offset, const Question& question, ServiceContext& context);

    // Used by the server.

    /// The channel's worker has finished, or will not do the work (see ServerChannel::work_done).
    void channel_work_done(StatusCode status, TimePoint now);
    [[nodiscard]] bool has_activated_session() const;
    /// Ends the session's operations with this handle; returns their number (Part 4, 5.7.5).
    std::uint32_t cancel(const Session& session, std::uint32_t request_handle);
    void close(StatusCode status, std::string_view reason);
    /// Closes because of something that the peer did or failed to do, which the log explains.
    void close(const Refusal& refusal);
    /// Destroys the operations that have answered.
    void sweep();
    [[nodiscard]] TimePoint created() const { return created_; }
    /// Removes it from Core::changed, where it is the first.
    void take_mark() { mark_.splice(mark_.end(), core_.changed, core_.changed.begin()); }

private:
    /// Active while one of the engine's own members runs, whose caller checks the output anyway.
    class Running;

    void trust_peer();
    [[nodiscard]] bool has_room() const;
    void work(TimePoint now);
    void give_turns(TimePoint now);
    void handle(channel::ChannelEvent event, TimePoint now);
    void survive(FunctionRef<void()> work);
    void serve(ServiceOperation& operation, FunctionRef<void()> part);
    void handle_closed(StatusCode status, std::string reason);
    void pass_time(TimePoint now);
    void check_silence(TimePoint now);
    void answered(const Reply& reply);
    void check_send_queue();

    Core& core_;
    std::uint64_t id_;
    std::string peer_address_;
    std::uint32_t listener_{0};
    PeerLog log_;
    ConnectionGate gate_;
    ChannelWork work_;
    channel::ServerChannel channel_;
    std::vector<std::unique_ptr<ServiceOperation>> operations_;
    std::vector<Session*> sessions_;
    std::vector<ConnectionEvent> events_;
    Turn turn_;
    /// The request that is being started, until it has an answer.
    std::optional<std::uint32_t> unanswered_;
    /// The turn ended before all input was processed.
    bool has_more_{false};
    TimePoint created_;
    /// The last time that was passed.
    TimePoint now_;
    /// The time by which there must be an activated session.
    TimePoint session_check_;
    /// The time by which the peer must have taken some output.
    TimePoint send_check_{no_deadline};
    bool has_progressed_{false};
    bool is_running_{false};
    /// Its entry for Core::changed while it is not there, so that one is always available.
    std::list<PeerLink*> mark_{this};
    bool waits_for_sweep_{false};
    bool has_ended_{false};
    /// The peer took nothing for too long; the rest is not offered any more.
    bool has_given_up_{false};
};

struct Core;
class PeerLink;

/// Processes one request of `link`: finds its service, checks the request header and the session,
/// and answers or leaves an Operation waiting (Part 4, 7.32 and 7.33).
void dispatch(Core& core, PeerLink& link, std::vector<std::byte> message, std::uint32_t request_id,
              TimePoint now);

} // namespace busbar::server::detail
