#include "discovery.hpp"

namespace busbar::cli {

DiscoveryConnection::DiscoveryConnection(Context& context)
    : url_{context.options.url}, log_{context.options.is_verbose}, environment_{&random_,
                                                                                &wall_clock_, &log_,
                                                                                nullptr, nullptr}
{
    const auto timeout = std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::duration<double>{context.options.timeout});
    client::ConnectionConfig config;
    config.channel.endpoint_url = url_;
    config.wants_session = false;
    config.request_timeout = timeout;
    auto connected = loop_.connect(std::move(config), environment_, timeout);
    if (connected) {
        connected = loop_.wait_until_ready();
    }
    if (!connected) {
        throw Failure{connected.error(), url_};
    }
}

} // namespace busbar::cli
