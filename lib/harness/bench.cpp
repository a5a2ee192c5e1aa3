#include <busbar/harness/bench.hpp>

#include <array>
#include <stdexcept>
#include <utility>
#include <variant>

#include <busbar/harness/identity.hpp>
#include <busbar/harness/report.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::harness {

Bench::Bench(BenchOptions options)
    : Bench{std::make_unique<World>(options.seed), std::move(options)}
{
}

Bench::Bench(std::unique_ptr<World> world, BenchOptions options) : Bench{*world, std::move(options)}
{
    own_world_ = std::move(world);
}

Bench::Bench(World& world, BenchOptions options)
    : world_{world}, client_config_{options.client}, client_parts_{options.client_parts},
      server_{world_, std::move(options.server), options.server_parts},
      first_{world_, std::move(options.client), options.client_parts}
{
    static_cast<void>(server_.server()); // throws if there is none
}

Result<NodeId> Bench::add_variable(std::string_view name, const model::BoundValue& value,
                                   model::Access access)
{
    model::AddressSpace& space = server().address_space();
    const auto added = space.add_variable(space.find(id::ObjectsFolder),
                                          QualifiedName{1, String{name}}, value, access);
    if (!added) {
        return fail(added.error());
    }
    return NodeId{1, String{name}};
}

BenchClient& Bench::client(std::string_view name)
{
    const auto known = further_.find(name);
    if (known != further_.end()) {
        return *known->second;
    }
    ClientParts parts = client_parts_;
    parts.log = nullptr;
    return add_client(std::string{name}, client_config_, std::move(parts));
}

BenchClient& Bench::log_in(client::UserIdentity user, channel::SecuritySetting security)
{
    static constexpr std::array<const char*, 4> kinds{"anonymous", "", "certificate", "issued"};
    const auto* const named = std::get_if<client::NamedUser>(&user);
    const std::string base = named != nullptr ? named->user_name : kinds.at(user.index());
    std::string name = base;
    for (int number = 2; further_.contains(name); ++number) {
        name = base + " " + std::to_string(number);
    }
    client::ConnectionConfig config = client_config_;
    config.identity = std::move(user);
    config.channel.security = security;
    ClientParts parts = client_parts_;
    parts.log = nullptr;
    if (const auto& identity = server().config().identity) {
        config.channel.server_certificate = identity->certificates.front(); // also for passwords
    }
    if (!security.policy->is_none() && parts.identity == nullptr) {
        parts.identity = &default_client_identity();
    }
    BenchClient& client = add_client(std::move(name), std::move(config), std::move(parts));
    need(client.connect());
    return client;
}

BenchClient& Bench::add_client(std::string name, client::ConnectionConfig config, ClientParts parts)
{
    if (further_.contains(name)) {
        throw std::invalid_argument{"add_client(): there is a client " + name};
    }
    const auto is_taken = [&] {
        return parts.address == client_parts_.address || parts.address == ClientParts{}.address;
    };
    for (std::size_t i = further_.size(); is_taken(); ++i) {
        parts.address = "192.0.2." + std::to_string(2 + i % 250);
    }
    if (parts.log == nullptr) {
        parts.log = &world_.new_log(name);
    }
    world_.network().name_client(parts.address, name);
    auto made = std::make_unique<BenchClient>(world_, std::move(config), parts);
    return *further_.emplace(std::move(name), std::move(made)).first->second;
}

} // namespace busbar::harness
