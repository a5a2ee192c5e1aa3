#pragma once

#include <functional>
#include <memory>

#include <busbar/net/discovery_registration.hpp>

#include "client_driver.hpp"

namespace busbar::net::detail {

/// A client::Registration with its Client on an executor. All calls are made there; it must not run
/// handlers any more when the object is destroyed.
class DiscoveryRegistration {
public:
    /// The objects of `environment` must outlive the object.
    DiscoveryRegistration(const asio::any_io_executor& executor, DiscoveryRegistrationConfig config,
                          const channel::ChannelEnvironment& environment);
    DiscoveryRegistration(const DiscoveryRegistration&) = delete;
    DiscoveryRegistration& operator=(const DiscoveryRegistration&) = delete;
    ~DiscoveryRegistration();

    void start();
    /// Unregisters and calls `on_stopped`, later, when that is done or its time is over.
    void stop(std::function<void()> on_stopped);
    /// Registers again after stop().
    void start_again();
    [[nodiscard]] bool is_stopped() const;

private:
    [[nodiscard]] channel::ChannelEnvironment
    with_log(const channel::ChannelEnvironment& environment);
    void step();

    client::OnceLog log_;
    channel::ChannelEnvironment environment_;
    std::shared_ptr<ClientDriver> driver_;
    client::Registration registration_;
    DeadlineTimer timer_;
    std::function<void()> on_stopped_;
};

} // namespace busbar::net::detail
