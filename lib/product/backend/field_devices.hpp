#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <busbar/backend/device.hpp>
#include <busbar/backend/device_source.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>
#include <busbar/net/device_driver.hpp>
#include <busbar/server/server.hpp>

#include "backend_config.hpp"

namespace busbar::product {

/// The PLCs of the backends of a configuration, with their Variables. For each backend there is
/// a folder below Objects with its name, which has its Variables and an Object "Connection" with
/// the state of the connection. On the server's thread but for publish().
class FieldDevices {
public:
    /// All three must outlive the object.
    FieldDevices(const std::vector<BackendConfig>& configs, const WallClock& clock, LogSink& log);
    FieldDevices(const FieldDevices&) = delete;
    FieldDevices& operator=(const FieldDevices&) = delete;
    ~FieldDevices();

    /// Adds the nodes. Once, on any thread, before the server is served; it must end before this
    /// object. Throws ConfigError.
    void publish(server::Server& server);
    /// Connects to the PLCs, and keeps that up until stop().
    void start(net::ServerLoop& loop);
    /// Ends the connections: another object may have them.
    void stop();
    /// Number of Variables that are in PLCs.
    [[nodiscard]] std::size_t size() const;

private:
    struct One {
        One(const BackendConfig& c, const WallClock& clock, LogSink& log);

        const BackendConfig& config;
        backend::Device device;
        backend::DeviceSource source;
        std::unique_ptr<net::DeviceDriver> driver;
    };

    std::vector<std::unique_ptr<One>> all_;
    LogSink& log_;
};

} // namespace busbar::product
