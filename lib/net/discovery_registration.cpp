#include "discovery_registration.hpp"

#include <utility>

namespace busbar::net {

client::RegistrationSettings registration_of(const server::ServerConfig& config,
                                             const std::vector<std::string>& discovery_urls)
{
    client::RegistrationSettings settings;
    RegisteredServer& server = settings.server;
    server.server_uri = config.application_uri;
    server.product_uri = config.product_uri;
    // As the server describes itself: in one language, whatever locales there are.
    server.server_names.push_back(
        LocalizedText{config.locale_ids.empty() ? String{} : String{config.locale_ids.front()},
                      String{config.application_name}});
    server.server_type = ApplicationType::Server;
    server.discovery_urls.clear();
    for (const std::string& url : discovery_urls) {
        server.discovery_urls.push_back(String{url});
    }
    settings.mdns.server_capabilities.push_back(String{"DA"}); // Part 12, Annex D
    return settings;
}

namespace detail {

DiscoveryRegistration::DiscoveryRegistration(const asio::any_io_executor& executor,
                                             DiscoveryRegistrationConfig config,
                                             const channel::ChannelEnvironment& environment)
    : log_{*environment.log}, environment_{with_log(environment)},
      driver_{std::make_shared<ClientDriver>(executor, std::move(config.client), environment_)},
      registration_{driver_->client(), log_, *environment.random, std::move(config.settings)},
      timer_{executor}
{
    driver_->on_step([this] { step(); });
}

DiscoveryRegistration::~DiscoveryRegistration()
{
    timer_.cancel();
    driver_->stop();
}

channel::ChannelEnvironment
DiscoveryRegistration::with_log(const channel::ChannelEnvironment& environment)
{
    channel::ChannelEnvironment changed = environment;
    changed.log = &log_;
    return changed;
}

void DiscoveryRegistration::start()
{
    registration_.start(now());
    driver_->wake();
}

void DiscoveryRegistration::stop(std::function<void()> on_stopped)
{
    on_stopped_ = std::move(on_stopped);
    registration_.stop(now());
    driver_->wake();
}

void DiscoveryRegistration::start_again()
{
    registration_.start_again(now());
    driver_->wake();
}

bool DiscoveryRegistration::is_stopped() const
{
    return registration_.is_stopped();
}

/// Called after each step of the Client, and at the Registration's deadline.
void DiscoveryRegistration::step()
{
    if (on_stopped_ && registration_.is_stopped()) {
        std::exchange(on_stopped_, nullptr)();
        return;
    }
    timer_.await(registration_.next_deadline(), [this] {
        driver_->wake(); // first, since it must not depend on what follows
        registration_.handle_deadline(now());
    });
}

} // namespace detail
} // namespace busbar::net
