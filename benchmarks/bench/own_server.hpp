#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include <sys/types.h>

#include <busbar/core/result.hpp>

namespace busbar::bench {

/// The one user that it may know.
inline constexpr std::string_view good_user = "operator";
inline constexpr std::string_view good_password = "Good-Password-1";

/// What the server is like.
struct OwnServerOptions {
    /// With a certificate and an endpoint Basic256Sha256, SignAndEncrypt.
    bool is_secure{false};
    /// Lets OpenSecureChannels come as often as they do.
    bool is_unrationed{false};
    /// Knows one user (good_user), whose password a thread of its own checks.
    bool has_user{false};
    /// Has place for thousands of sessions of one user at one address.
    bool is_large{false};
    /// Does their asymmetric work on a thread of its own.
    bool has_worker{false};
    /// Int16, which anybody may write: ns=2;s=Bulk0, Bulk1 and so on.
    std::size_t variables{0};
};

/// A server of this library with little but namespace 0, in a process of its own: what it takes of
/// memory and time is its alone.
class OwnServer {
public:
    /// Before this process has threads. Bad_CommunicationError if there is no port or process.
    [[nodiscard]] static Result<std::unique_ptr<OwnServer>>
    start(const OwnServerOptions& options = {});
    OwnServer(const OwnServer&) = delete;
    OwnServer& operator=(const OwnServer&) = delete;
    /// Ends the process.
    ~OwnServer();

    [[nodiscard]] const std::string& url() const { return url_; }
    [[nodiscard]] pid_t process() const { return process_; }

private:
    OwnServer(pid_t process, int port);

    pid_t process_;
    std::string url_;
};

} // namespace busbar::bench
