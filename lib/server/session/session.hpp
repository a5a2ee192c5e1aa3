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

#include "peer.hpp"
#include "server/rights/node_rights.hpp"
#include "server/rights/registered_nodes.hpp"

namespace busbar::server::detail {

class Peer;
struct Share;

/// The cause of a session's end (Part 4, 6.5.6).
enum class SessionEnd : std::uint8_t { CloseSession, Timeout, Terminated };

/// The state of one service set in a session; destroyed with it.
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
    /// Until it is activated, it has only `sessionless_memory` of `max_memory`.
    Session(std::size_t max_memory, std::uint64_t sessionless_memory)
        : memory_left_{sessionless_memory < max_memory
                           ? static_cast<std::size_t>(sessionless_memory)
                           : max_memory},
          memory_kept_back_{max_memory - memory_left_}
    {
    }

    /// Charges for memory that the session makes the server hold; false, with nothing charged, if
    /// it has not that much left.
    [[nodiscard]] bool charge(std::size_t bytes)
    {
        if (bytes > memory_left_) {
            return false;
        }
        memory_left_ -= bytes;
        return true;
    }
    void release(std::size_t bytes) { memory_left_ += bytes; }
    /// Called on activation: all of its memory is available from now on.
    void have_all_memory() { memory_left_ += std::exchange(memory_kept_back_, 0); }
    /// Sets the user. Of a long history the creator and the latest are kept.
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
    /// Called for each request.
    void touch(TimePoint now) { deadline = std::min(now + timeout, ends_at); }
    /// The time when it ends or loses its user, if no request arrives.
    [[nodiscard]] TimePoint next_deadline() const { return std::min(deadline, user_deadline); }

    NodeId id;
    NodeId authentication_token;
    std::string name;
    std::vector<std::string> locale_ids;
    bool is_activated{false};
    /// Valid once it is over.
    SessionEnd end{SessionEnd::Terminated};
    /// Not all of its Subscriptions know its present user.
    bool is_user_untold{false};
    /// Number of times it was given to a user.
    std::uint32_t user_changes{0};
    /// The mark of the CloseSession that ended it.
    RequestMark end_mark{};
    UserIdentity user;
    /// The user as the UserStore returned it, without the roles of rules.
    UserIdentity granted;
    /// The ClientUserId of the first user, followed by those of later ones, the latest last.
    std::vector<std::string> users;
    /// The time when the user becomes anonymous (see expire_user()).
    TimePoint user_deadline{no_deadline};

    /// Pending requests, over any channel.
    std::size_t pending_operations{0};
    /// The connection whose channel it is bound to; null while there is none.
    Peer* peer{nullptr};
    /// The listener of the connection that it was activated over.
    std::uint32_t listener{0};
    /// The address without port; also that of the connection that it was created over.
    std::string address{};
    channel::SecuritySetting security;
    /// The leaf; none with SecurityPolicy None.
    crypto::CertificateChain client_certificate;
    /// The last nonce that was sent; used once.
    ByteString server_nonce;
    /// Bytes, 0 for no limit but the channel's.
    std::uint32_t max_response_message_size{0};
    std::string client_application_uri;
    /// As in CreateSession, without discovery URLs and with shortened texts.
    ApplicationDescription client_description;
    String server_uri;
    String endpoint_url;

    std::chrono::milliseconds timeout{0};
    TimePoint created;
    /// The time when it ends if no request arrives.
    TimePoint deadline{no_deadline};
    /// The time when it ends in any case.
    TimePoint ends_at{no_deadline};

    /// Continuation points of the View services.
    std::unique_ptr<SessionPart> view;
    /// Null until a node is registered.
    std::unique_ptr<RegisteredNodes> registered;
    /// Subscriptions, and waiting Publish requests.
    std::unique_ptr<SessionPart> publishing;

    // Its place in its SessionTable.

    TimePoint filed_for{no_deadline};
    Share* share{nullptr};
    /// Its share counts it as activated.
    bool is_shared_activated{false};

    /// Only counters; see Diagnostics.
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

/// Returns the rights of the session's user over its channel; `access` may be null.
[[nodiscard]] inline NodeRights rights_of(const Session& session, const model::AddressSpace& space,
                                          const AccessControl* access)
{
    return {space, session.user, access, session.security.mode};
}

} // namespace busbar::server::detail
