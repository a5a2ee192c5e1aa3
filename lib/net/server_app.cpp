#include <busbar/net/server_app.hpp>

#include <cstdio>
#include <optional>
#include <utility>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/text.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::net {

struct ServerApp::Impl {
    explicit Impl(std::string url) : endpoint_url{std::move(url)} {}

    [[nodiscard]] bool is_good() const { return status.has_value(); }
    void fail_with(Problem problem)
    {
        if (is_good()) {
            status = Unexpected{std::move(problem)};
        }
    }
    void open(ApplicationSettings settings);
    void listen();

    std::string endpoint_url;
    Configured<void> status;
    StderrLog log;
    std::unique_ptr<Application> application;
    ServerLoop loop{log};
    server::PasswordUsers users;
    /// Before the server, which uses them.
    std::vector<std::shared_ptr<server::DataSource>> sources;
    std::optional<server::MemorySource> memory;
    std::optional<server::Server> server;
};

void ServerApp::Impl::open(ApplicationSettings settings)
{
    auto opened = Application::open(std::move(settings), log);
    if (!opened) {
        return fail_with(opened.error());
    }
    application = *std::move(opened);
    server::ServerConfig config = application->server_config(endpoint_url);
    const server::ServerEnvironment environment = application->server_environment(loop, &users);
    auto made = server::Server::create(std::move(config), environment);
    if (!made) {
        return fail_with(made.error());
    }
    server.emplace(*std::move(made));
    memory.emplace(application->wall_clock());
    server->add_source(*memory);
}

void ServerApp::Impl::listen()
{
    const auto url = channel::EndpointUrl::parse(endpoint_url); // valid, since the server exists
    if (const auto listening = loop.listen("", url->port); !listening) {
        fail_with({listening.error(), "port " + std::to_string(url->port),
                   "cannot be opened for listening. Choose another port, or stop the program that "
                   "uses it"});
    }
}

ServerApp::ServerApp(ApplicationSettings settings, std::string endpoint_url)
    : impl_{std::make_unique<Impl>(std::move(endpoint_url))}
{
    impl_->open(std::move(settings));
}

ServerApp::~ServerApp() = default;

void ServerApp::add_user(std::string_view name, const char* password)
{
    if (!impl_->is_good()) {
        return;
    }
    const std::string where = "user \"" + printable(name) + "\"";
    if (password == nullptr) {
        return impl_->fail_with(
            {status::Bad_InvalidArgument, where,
             "has no password. Set the environment variable that it is taken from"});
    }
    const auto added = impl_->users.add(name, password, impl_->application->random());
    if (!added) {
        Problem problem = problem_of(added.error());
        problem.where = where + ": " + problem.where;
        impl_->fail_with(std::move(problem));
    }
}

std::uint16_t ServerApp::add_namespace(std::string_view uri)
{
    if (!impl_->is_good()) {
        return 0;
    }
    const auto added = impl_->server->address_space().add_namespace(uri);
    if (!added) {
        impl_->fail_with(
            {added.error(), "namespace \"" + printable(uri) + "\"", "cannot be added"});
    }
    return added.value_or(0);
}

void ServerApp::add_source(std::shared_ptr<server::DataSource> source)
{
    if (impl_->is_good()) {
        impl_->server->add_source(*source);
    }
    impl_->sources.push_back(std::move(source));
}

std::uint64_t ServerApp::add_variable(const QualifiedName& name, const model::BoundValue& value,
                                      model::Access access)
{
    if (!impl_->is_good()) {
        return 0;
    }
    model::AddressSpace& space = impl_->server->address_space();
    model::BoundValue bound = value;
    if (bound.source == model::no_source && !bound.value.is_null()) {
        bound = impl_->memory->variable(bound.value);
        bound.data_type = value.data_type;
    }
    const auto added = space.add_variable(space.find(id::ObjectsFolder), name, bound, access);
    if (!added) {
        impl_->fail_with(
            {added.error(), "variable \"" + printable(name.name.view()) + "\"", "cannot be added"});
        return 0;
    }
    return bound.handle;
}

void ServerApp::set(std::uint64_t variable, Variant value)
{
    if (impl_->is_good()) {
        impl_->memory->set(variable, std::move(value));
    }
}

const Configured<void>& ServerApp::status() const
{
    return impl_->status;
}

server::Server* ServerApp::server()
{
    return impl_->server ? &*impl_->server : nullptr;
}

server::PasswordUsers& ServerApp::users()
{
    return impl_->users;
}

int ServerApp::run()
{
    if (impl_->is_good()) {
        impl_->listen();
    }
    if (!impl_->is_good()) {
        std::fprintf(stderr, "%s\n", text(impl_->status.error()).c_str());
        return 1;
    }
    impl_->log.write(LogLevel::Info, "server", "ready at " + impl_->endpoint_url);
    impl_->loop.stop_on_signals();
    impl_->loop.run(*impl_->server);
    return 0;
}

} // namespace busbar::net
