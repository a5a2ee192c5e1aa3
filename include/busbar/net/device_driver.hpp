#pragma once

#include <functional>
#include <memory>

#include <busbar/backend/device.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>
#include <busbar/net/server_loop.hpp>

namespace busbar::net {

/// Connects a Device over TCP, or UDP if it says so, and connects it again whenever the connection
/// ends, until this is destroyed. Everything happens on the thread of the loop, which is the thread
/// of the device's DataSource; create and destroy it there, or while the loop does not run.
class BUSBAR_API DeviceDriver {
public:
    /// All three must outlive the object.
    DeviceDriver(ServerLoop& loop, backend::Device& device, LogSink& log);
    DeviceDriver(const DeviceDriver&) = delete;
    DeviceDriver& operator=(const DeviceDriver&) = delete;
    ~DeviceDriver();

private:
    struct Impl;

    std::unique_ptr<Impl> impl_;
};

/// Connects Devices in a program without a server: for tools and tests. For one thread.
class BUSBAR_API DeviceLoop {
public:
    /// `log` must outlive the object.
    explicit DeviceLoop(LogSink& log);
    DeviceLoop(const DeviceLoop&) = delete;
    DeviceLoop& operator=(const DeviceLoop&) = delete;
    ~DeviceLoop();

    /// Connects a device from now on; it must outlive the object.
    void add(backend::Device& device);
    /// Lets things happen until `is_done`, which is asked after each, returns true. False if
    /// `timeout` has passed before.
    [[nodiscard]] bool run_until(const std::function<bool()>& is_done, Duration timeout);

private:
    struct Impl;

    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::net
