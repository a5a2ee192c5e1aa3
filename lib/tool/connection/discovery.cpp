#include "discovery.hpp"

namespace busbar::tool {

namespace {

Duration timeout_of(const Options& options)
{
    return std::chrono::duration_cast<Duration>(std::chrono::duration<double>{options.timeout});
}

client::ClientConfig config_of(const Options& options, const std::string& url)
{
    client::ClientConfig config;
    config.endpoint_url = url;
    config.wants_session = false;
    config.security.allows_none = true;
    config.request_timeout = timeout_of(options);
    config.connect_timeout = timeout_of(options);
    config.reconnect.is_enabled = false;
    return config;
}

} // namespace

DiscoveryConnection::DiscoveryConnection(Context& context)
    : url_{complete_url(context.options.url)}, log_{context.options.is_verbose},
      environment_{.random = &random_, .wall_clock = &wall_clock_, .log = &log_},
      client_{config_of(context.options, url_), environment_}
{
    const auto connected = client_.connect(timeout_of(context.options));
    if (!connected) {
        if (const std::string refusal = log_.refusal_with(connected.error()); !refusal.empty()) {
            throw refused_by_us(connected.error(), url_, refusal);
        }
        throw connect_failure(connected.error(), url_, log_.why_unconnected());
    }
}

} // namespace busbar::tool
