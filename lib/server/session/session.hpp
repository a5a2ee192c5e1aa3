#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/types.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/discovery.hpp>

#include "server/rights/registered_nodes.hpp"

#include "peer.hpp"

namespace busbar::server::detail {

class Peer;
struct Share;

/// The cause of a session's end (Part 4, 6.5.6).
enum class SessionEnd : std::uint8_t { CloseSession, Timeout, Terminated };

/// What one service set keeps in a session; destroyed with it.
class SessionPart {
public:
    SessionPart() = default;
    SessionPart(const SessionPart&) = delete;
    SessionPart& operator=(const SessionPart&) = delete;
    virtual ~SessionPart() = default;
};

/// A Session (Part 4, 5.7). Fields are plain: the session services change them, others read.
class Session {
public:
    /// Of `max_memory` it has `sessionless_memory` until it is activated.
    Session(std::size_t max_memory, std::uint64_t sessionless_memory)
        : memory_left_{sessionless_memory < max_memory
                           ? static_cast<std::size_t>(sessionless_memory)
                           : max_memory},
          memory_kept_back_{max_memory - memory_left_}
    {
    }

    /// Charges what the session makes the server hold; false, and nothing is charged, if it has
    /// not that much left.
    [[nodiscard]] bool charge(std::size_t bytes)
    {
        if (bytes > memory_left_) {
            return false;
        }
        memory_left_ -= bytes;
        return true;
    }
    void release(std::size_t bytes) { memory_left_ += bytes; }
    /// It is activated: it has all of its memory from now on.
    void have_all_memory() { memory_left_ += std::exchange(memory_kept_back_, 0); }
    /// From now on it is this user's. Of a long history the creator and the latest are kept.
    void change_user(UserIdentity next)
    {
        constexpr std::size_t most = 8;
        if (users.empty() || users.back() != next.name) {
            if (users.size() == most) {
                users.erase(users.begin() + 1);
            }
            users.push_back(next.name);
        }
        user = std::move(next);
        ++user_changes;
    }
    /// A request has come.
    void touch(TimePoint now) { deadline = std::min(now + timeout, ends_at); }
    /// When it ends or loses its user, if no request comes.
    [[nodiscard]] TimePoint next_deadline() const { return std::min(deadline, user_deadline); }

    NodeId id;
    NodeId authentication_token;
    std::string name;
    std::vector<std::string> locale_ids;
    bool is_activated{false};
    /// Once it is over.
    SessionEnd end{SessionEnd::Terminated};
    /// Its Subscriptions have not all heard whose it is now.
    bool is_user_untold{false};
    /// How often it was given to a user.
    std::uint32_t user_changes{0};
    /// Of the CloseSession that ended it.
    RequestMark end_mark{};
    UserIdentity user;
    /// The same as the UserStore gave it, without the roles of rules.
    UserIdentity granted;
    /// The ClientUserId of whoever activated it first, then those it was given to, the latest last.
    std::vector<std::string> users;
    /// When the user becomes an anonymous one (see user_expiry.hpp).
    TimePoint user_deadline{no_deadline};

    /// Requests that wait for their answers, over whichever channel.
    std::size_t pending_operations{0};
    /// The connection whose channel it is bound to; null while there is none.
    Peer* peer{nullptr};
    /// Of the connection that it was activated over.
    std::uint32_t listener{0};
    /// Without port; also of the connection that it was created over.
    std::string address{};
    channel::SecuritySetting security;
    /// The leaf; none with SecurityPolicy None.
    crypto::CertificateChain client_certificate;
    /// The last one that was given out; single use.
    ByteString server_nonce;
    /// Bytes, 0 for no limit but the channel's.
    std::uint32_t max_response_message_size{0};
    std::string client_application_uri;
    /// As CreateSession told them, without discovery URLs and with texts cut short.
    ApplicationDescription client_description;
    String server_uri;
    String endpoint_url;

    std::chrono::milliseconds timeout{0};
    TimePoint created;
    /// When it ends if no request comes.
    TimePoint deadline{no_deadline};
    /// When it ends whatever comes.
    TimePoint ends_at{no_deadline};

    /// Continuation points of the View services.
    std::unique_ptr<SessionPart> view;
    /// Null until it registers a node.
    std::unique_ptr<RegisteredNodes> registered;
    /// Subscriptions, and Publish requests that wait.
    std::unique_ptr<SessionPart> publishing;

    // Where it stands in its SessionTable.

    TimePoint filed_for{no_deadline};
    Share* share{nullptr};
    /// It counts there as activated.
    bool is_shared_activated{false};

    /// Only what is counted; see Diagnostics.
    SessionDiagnosticsDataType diagnostics;
    std::uint32_t diagnostics_round{0};
    DateTime connection_time;

private:
    std::size_t memory_left_;
    std::size_t memory_kept_back_;
};

[[nodiscard]] inline bool is_encrypted(const Session& session)
{
    return session.security.mode == MessageSecurityMode::SignAndEncrypt;
}

} // namespace busbar::server::detail
