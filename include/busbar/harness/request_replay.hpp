#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/harness/connection_host.hpp>
#include <busbar/harness/recorded_messages.hpp>
#include <busbar/harness/scripted_server.hpp>

namespace busbar::harness {

/// Says how recorded requests are sent again.
struct RequestReplayOptions {
    /// The longest time that an answer takes.
    Duration answer_limit{std::chrono::seconds{10}};
    /// Leaves the recorded time between two requests; else the next one is sent as soon as what was
    /// answered before it is.
    bool keeps_pace{false};
};

/// Sends the requests of a recording in a new session, in their order, and each after the answers
/// that came before it. What the server chose, ids of Subscriptions, of their items and of
/// registered nodes, and ContinuationPoints of Browse and HistoryRead, is that of the new session;
/// what makes and ends a session is not repeated.
///
/// `config` says where and as whom; the world, which may be a RealWorld, runs until all is over.
/// The recorded channel must have been readable (policy None), the new one may have any security.
/// The error is that of the session.
[[nodiscard]] BUSBAR_API Result<std::vector<RecordedMessage>>
replay_requests(World& world, const Recording& recording, client::ConnectionConfig config,
                const ClientParts& parts = {}, const RequestReplayOptions& options = {});

/// Returns the messages that replay_requests() repeats, numbered as in the recording, to be
/// compared with what it returns.
[[nodiscard]] BUSBAR_API std::vector<RecordedMessage> repeated_messages(const Recording& recording);

/// Answers requests as a recorded server did. A request is answered as the first recorded one with
/// the same content that was not used yet, or as the last one if all were; a Publish only by one
/// that was not. The server creates sessions of its own for every client, and its state is its own;
/// what was not recorded is answered by Bad_ServiceUnsupported and reported. One thread; world and
/// recording must outlive it.
class BUSBAR_API RecordedServer {
public:
    /// Listens at the URL.
    RecordedServer(World& world, std::string_view url, const Recording& recording,
                   const ScriptedServerParts& parts = {});
    ~RecordedServer();
    RecordedServer(const RecordedServer&) = delete;
    RecordedServer& operator=(const RecordedServer&) = delete;

    /// The requests that were not recorded, one a line.
    [[nodiscard]] std::string report() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::harness
