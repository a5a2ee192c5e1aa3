#include <busbar/net/device_driver.hpp>

#include <utility>
#include <vector>

#include <asio/io_context.hpp>

#include "device_link.hpp"
#include "server_loop_impl.hpp"

namespace busbar::net {

struct DeviceDriver::Impl {
    explicit Impl(std::shared_ptr<detail::DeviceLink> l) : link{std::move(l)} {}

    std::shared_ptr<detail::DeviceLink> link;
};

DeviceDriver::DeviceDriver(ServerLoop& loop, backend::Device& device, LogSink& log)
    : impl_{std::make_unique<Impl>(
          std::make_shared<detail::DeviceLink>(loop.impl_->context.get_executor(), device, log))}
{
    impl_->link->start();
}

DeviceDriver::~DeviceDriver()
{
    impl_->link->stop();
}

struct DeviceLoop::Impl {
    explicit Impl(LogSink& l) : log{&l} {}

    LogSink* log;
    asio::io_context context;
    std::vector<std::shared_ptr<detail::DeviceLink>> links;
};

DeviceLoop::DeviceLoop(LogSink& log) : impl_{std::make_unique<Impl>(log)} {}

DeviceLoop::~DeviceLoop()
{
    for (const auto& link : impl_->links) {
        link->stop();
    }
}

void DeviceLoop::add(backend::Device& device)
{
    impl_->links.push_back(
        std::make_shared<detail::DeviceLink>(impl_->context.get_executor(), device, *impl_->log));
    impl_->links.back()->start();
}

bool DeviceLoop::run_until(const std::function<bool()>& is_done, Duration timeout)
{
    const TimePoint end = detail::after(timeout);
    while (!is_done()) {
        impl_->context.restart();
        if (impl_->context.run_one_until(end) == 0 && detail::now() >= end) {
            return is_done();
        }
    }
    return true;
}

} // namespace busbar::net
