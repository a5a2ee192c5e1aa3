#include <busbar/harness/identity.hpp>
#include <busbar/harness/server_host.hpp>

#include <limits>
#include <stdexcept>
#include <utility>

namespace busbar::harness {

/// While it exists, the server's own code runs.
class ServerHost::Inside {
public:
    explicit Inside(const ServerHost& host) : watch_{host.parts_.watch}
    {
        if (watch_ != nullptr) {
            watch_->enter();
        }
    }
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;
    ~Inside()
    {
        if (watch_ != nullptr) {
            watch_->leave();
        }
    }

private:
    EngineWatch* watch_;
};

/// The server's end of a link.
class ServerHost::Peer final : public LinkEnd {
public:
    Peer(ServerHost& host, server::Connection connection, std::shared_ptr<Link> link)
        : host_{host}, connection_{std::move(connection)}, link_{std::move(link)},
          deadline_{host.scheduler_,
                    [this] { work([&](TimePoint now) { connection_->handle_deadline(now); }); }}
    {
        update();
    }
    ~Peer() override
    {
        if (!has_ended_) {
            link_->leave(Side::Server);
        }
        const Inside inside{host_};
        connection_.reset();
    }

    [[nodiscard]] std::span<const std::byte> output() const override
    {
        return connection_->output();
    }
    void consume(std::size_t size) override
    {
        const Inside inside{host_};
        connection_->consume(size);
    }
    void feed(std::span<const std::byte> in) override
    {
        work([&](TimePoint now) { static_cast<void>(connection_->feed(in, now)); });
    }
    void link_lost() override { end(); }

    void update()
    {
        {
            const Inside inside{host_};
            while (connection_->next_event()) {
            }
        }
        link_->flush(Side::Server);
        if (connection_->is_closed() && connection_->output().empty()) {
            link_->close(Side::Server);
            end();
        } else {
            deadline_.set(connection_->next_deadline());
        }
    }

private:
    template <typename Work>
    void work(Work call)
    {
        {
            const Inside inside{host_};
            call(host_.scheduler_.now());
        }
        update();
        host_.settle();
    }
    void end()
    {
        deadline_.cancel();
        if (!std::exchange(has_ended_, true)) {
            host_.ended_.push_back(connection_->id());
            host_.forget_.set_after(Duration{0});
        }
    }

    ServerHost& host_;
    /// Empty only while it ends.
    std::optional<server::Connection> connection_;
    std::shared_ptr<Link> link_;
    bool has_ended_{false};
    Alarm deadline_;
};

server::ServerConfig open_server_config()
{
    server::ServerConfig config;
    config.application_uri = "urn:busbar:harness:server";
    config.endpoint_url = "opc.tcp://server:4840";
    config.endpoints = {{}};
    config.endpoints[0].allows_anonymous = true;
    config.endpoints[0].allows_user_name = false; // user names need a certificate
    config.limits.max_log_lines_per_minute = std::numeric_limits<std::size_t>::max();
    return config;
}

server::ServerConfig secured_server_config()
{
    server::ServerConfig config = open_server_config();
    config.identity = default_server_identity();
    const auto secured = server::secure_endpoints();
    config.endpoints.insert(config.endpoints.end(), secured.begin(), secured.end());
    for (server::EndpointConfig& endpoint : config.endpoints) {
        endpoint.allows_anonymous = endpoint.allows_user_name = true;
    }
    return config;
}

void TestUsers::add(std::string name, std::string password, server::UserRights rights)
{
    users_.insert_or_assign(std::move(name), User{std::move(password), std::move(rights)});
}

Result<server::UserIdentity> TestUsers::log_in(std::string_view name, std::string_view password)
{
    const auto found = users_.find(name);
    if (found == users_.end() || found->second.password != password) {
        return fail(status::Bad_UserAccessDenied);
    }
    const server::UserRights& rights = found->second.rights;
    return server::UserIdentity{UserTokenType::UserName, found->first, rights.access_level_mask,
                                rights.roles};
}

ServerHost::ServerHost(World& world, server::ServerConfig config, const ServerParts& parts,
                       model::AddressSpace address_space)
    : ServerHost{world.scheduler(),
                 world.clock(),
                 parts.log != nullptr ? *parts.log : world.new_log(Actor::Server),
                 world.new_chance(Actor::Server),
                 std::move(config),
                 parts,
                 std::move(address_space),
                 &world.network().chunk_hook()}
{
    if (server_ == nullptr) {
        return;
    }
    const std::string url = server_->config().endpoint_url;
    if (world.network().listen(url, *this)) {
        network_ = &world.network();
        return;
    }
    problem_ = Problem{status::Bad_InvalidState, "endpoint_url", url + " has a listener already"};
    deadline_.cancel();
    server_.reset();
}

void ServerHost::need_server() const
{
    if (server_ == nullptr) {
        throw std::logic_error{"there is no server: " +
                               (problem_ ? text(*problem_) : std::string{})};
    }
}

ServerHost::ServerHost(Scheduler& scheduler, const WallClock& clock, LogSink& log, Chance chance,
                       server::ServerConfig config, const ServerParts& parts,
                       model::AddressSpace address_space, channel::ChunkHook* chunk_hook)
    : scheduler_{scheduler}, chance_{chance}, parts_{parts}, random_{chance_.next()},
      deadline_{scheduler, [this] { work([&](TimePoint now) { server_->handle_deadline(now); }); }},
      completions_{scheduler,
                   [this] { work([&](TimePoint now) { server_->handle_completions(now); }); }},
      forget_{scheduler, [this] { forget_ended(); }},
      woken_{scheduler, [this] { await_completions(); }}, touched_{scheduler, [this] { settle(); }}
{
    const server::ServerEnvironment environment{
        .random = &random_,
        .wall_clock = &clock,
        .log = &log,
        .validator = parts.validator != nullptr ? parts.validator : &accept_any_,
        .users = parts.users != nullptr ? parts.users : &users_,
        .access = parts.access,
        .roles = parts.roles,
        .waker = this,
        .key_log = parts.key_log,
        .chunk_hook = chunk_hook};
    auto created = server::Server::create(std::move(config), environment, std::move(address_space));
    if (!created) {
        problem_ = created.error();
    } else {
        server_ = std::make_unique<server::Server>(*std::move(created));
        server_->start(scheduler.now());
        settle();
    }
}

ServerHost::~ServerHost()
{
    if (network_ != nullptr) {
        network_->unlisten(*this);
    }
    peers_.clear();
}

template <typename Work>
void ServerHost::work(Work call)
{
    {
        const Inside inside{*this};
        call(scheduler_.now());
    }
    settle();
}

bool ServerHost::accept(const std::shared_ptr<Link>& link, std::string_view peer_address)
{
    auto connection = [&] {
        const Inside inside{*this};
        return server_->connect(peer_address, scheduler_.now());
    }();
    if (!connection) {
        return false;
    }
    const std::uint64_t id = connection->id();
    auto peer = std::make_unique<Peer>(*this, *std::move(connection), link);
    link->attach(Side::Server, *peer);
    peers_.emplace(id, std::move(peer));
    settle();
    return true;
}

void ServerHost::await_completions()
{
    if (completions_.is_set()) {
        return;
    }
    const bool is_rare = parts_.rare_wake_delay != Duration{0} && chance_.one_in(8);
    const Duration most = is_rare ? parts_.rare_wake_delay : parts_.wake_delay;
    completions_.set_after(most == Duration{0} ? most : chance_.between(Duration{0}, most));
}

void ServerHost::settle()
{
    if (server_ == nullptr) {
        return;
    }
    const auto next_changed = [&] {
        const Inside inside{*this};
        return server_->next_changed();
    };
    while (const auto id = next_changed()) {
        if (const auto found = peers_.find(*id); found != peers_.end()) {
            found->second->update();
        }
    }
    deadline_.set(server_->next_deadline());
}

void ServerHost::forget_ended()
{
    for (const std::uint64_t id : std::exchange(ended_, {})) {
        peers_.erase(id);
    }
    settle();
}

} // namespace busbar::harness
