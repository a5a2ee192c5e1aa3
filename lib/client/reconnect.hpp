#pragma once

#include <busbar/client/client.hpp>
#include <busbar/crypto/random.hpp>

namespace busbar::client::detail {

/// Why another attempt would end like the last one; empty if it may not.
[[nodiscard]] std::string_view final_reason(StatusCode status);

/// True if the server has no connection left for now.
[[nodiscard]] bool is_server_full(StatusCode status);

/// True if the server no longer has the session that a request was sent in.
[[nodiscard]] bool is_session_gone(StatusCode status);

/// How long to wait before the next attempt. Finite and more than nothing, whatever the policy
/// says: a server that refuses at once must not be asked without pause.
class BackOff {
public:
    explicit BackOff(const ReconnectPolicy& policy);

    [[nodiscard]] Duration next(crypto::Random& random);
    void reset() { next_ = first_; }

private:
    Duration first_;
    Duration longest_;
    double factor_;
    Duration next_;
};

} // namespace busbar::client::detail
