#pragma once

#include <busbar/client/client.hpp>
#include <busbar/crypto/random.hpp>

namespace busbar::client::detail {

/// Returns why another attempt would end like the last one; empty if it may succeed.
[[nodiscard]] std::string_view final_reason(StatusCode status);

/// True if the server has no free connection for now.
[[nodiscard]] bool is_server_full(StatusCode status);

/// True if the server no longer has the request's session.
[[nodiscard]] bool is_session_gone(StatusCode status);

/// Computes the delay before the next attempt. Finite and more than zero, whatever the policy
/// contains: a server that refuses at once must not be tried without pause.
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
