#pragma once

#include <busbar/client/registration.hpp>
#include <busbar/core/api.hpp>
#include <busbar/harness/client_host.hpp>

namespace busbar::harness {

/// Runs a client::Registration with its Client in a world. One thread; the world must outlive it.
class BUSBAR_API RegistrationHost {
public:
    /// `config` comes from registration_client().
    RegistrationHost(World& world, client::ClientConfig config,
                     client::RegistrationSettings settings, ClientParts parts = {});

    void start();
    /// Stops it and runs the world until that is done.
    void stop(Duration limit = std::chrono::minutes{1});
    /// Registers the server again after stop().
    void start_again();
    [[nodiscard]] const client::Registration& registration() const { return registration_; }
    [[nodiscard]] bool is_registered() const { return registration_.is_registered(); }
    /// Runs the world until the last attempt has succeeded, or has failed if `is_wanted` is false.
    /// Returns whether it did.
    [[nodiscard]] bool await_registered(bool is_wanted, Duration limit);

private:
    [[nodiscard]] ClientParts with_log(ClientParts parts);
    void await_deadline() { deadline_.set(registration_.next_deadline()); }

    World& world_;
    client::OnceLog log_;
    SeededRandom random_;
    ClientHost client_;
    client::Registration registration_;
    Alarm deadline_;
};

} // namespace busbar::harness
