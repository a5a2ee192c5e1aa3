#include <busbar/net/application.hpp>

#include <optional>

#include <busbar/crypto/own_certificate.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/store_validator.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/net/system.hpp>
#include <busbar/storage/folder_storage.hpp>

namespace busbar::net {

namespace {

crypto::OwnCertificateSettings certificate_of(const ApplicationSettings& settings)
{
    crypto::OwnCertificateSettings result;
    result.subject.common_name = settings.name;
    result.subject.organization = settings.name;
    result.subject.application_uri = settings.uri;
    for (const std::string& host : settings.host_names) {
        crypto::add_host(result.subject, host);
    }
    return result;
}

} // namespace

struct Application::Impl {
    Impl(ApplicationSettings s, LogSink& log)
        : settings{std::move(s)}, storage{settings.folder}, store{storage, {}, log}, validator{
                                                                                         store, log}
    {
        environment.random = &random;
        environment.wall_clock = &wall_clock;
        environment.log = &log;
        environment.validator = &validator;
    }

    ApplicationSettings settings;
    crypto::SystemRandom random;
    SystemWallClock wall_clock;
    storage::FolderStorage storage;
    crypto::CertificateStore store;
    crypto::StoreValidator validator;
    std::optional<channel::ApplicationIdentity> identity;
    channel::ChannelEnvironment environment;
};

Application::Application(std::unique_ptr<Impl> impl) : impl_{std::move(impl)} {}
Application::~Application() = default;

Configured<std::unique_ptr<Application>> Application::open(ApplicationSettings settings,
                                                           LogSink& log)
{
    auto impl = std::make_unique<Impl>(std::move(settings), log);
    const ApplicationSettings& wanted = impl->settings;
    if (const auto made = impl->store.create(); !made) {
        return misconfigured("certificate folder \"" + wanted.folder + "\"",
                             "cannot be made (Part 12, F.1). Make it writable for this user, or "
                             "name another",
                             made.error());
    }
    const crypto::OwnCertificateStore own{impl->storage};
    auto certificate = own.load_or_create(certificate_of(wanted), impl->wall_clock.now());
    if (!certificate) {
        return Unexpected{problem_of(certificate.error())};
    }
    impl->identity = channel::ApplicationIdentity{std::move(certificate->certificates),
                                                  std::move(certificate->key)};
    impl->environment.identity = &*impl->identity;
    return std::unique_ptr<Application>{new Application{std::move(impl)}};
}

server::ServerConfig Application::server_config(std::string endpoint_url) const
{
    server::ServerConfig config;
    config.endpoint_url = std::move(endpoint_url);
    config.application_uri = impl_->settings.uri;
    config.application_name = impl_->settings.name;
    config.host_names = impl_->settings.host_names;
    config.identity = impl_->identity;
    return config;
}

server::ServerEnvironment Application::server_environment(ServerLoop& loop,
                                                          server::UserStore* users)
{
    return {.random = &impl_->random,
            .wall_clock = &impl_->wall_clock,
            .log = impl_->environment.log,
            .validator = &impl_->validator,
            .users = users,
            .waker = &loop.waker()};
}

client::ClientConfig Application::client_config(std::string endpoint_url) const
{
    client::ClientConfig config;
    config.endpoint_url = std::move(endpoint_url);
    config.application_uri = impl_->settings.uri;
    config.application_name = impl_->settings.name;
    return config;
}

const channel::ChannelEnvironment& Application::client_environment() const
{
    return impl_->environment;
}

crypto::CertificateStore& Application::certificates()
{
    return impl_->store;
}

crypto::Random& Application::random()
{
    return impl_->random;
}

const WallClock& Application::wall_clock() const
{
    return impl_->wall_clock;
}

} // namespace busbar::net
