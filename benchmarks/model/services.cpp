#include "services.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>

#include <busbar/client/connection.hpp>
#include <busbar/client/response_limits.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/view.hpp>

#include "spaces.hpp"

namespace busbar::bench {

namespace {

constexpr int rounds = 10;

class FixedClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override
    {
        return DateTime::from_unix_seconds(1'800'000'000);
    }
};

[[noreturn]] void give_up(const std::string& why)
{
    std::fprintf(stderr, "busbar-model-bench: %s\n", why.c_str());
    std::exit(1);
}

template <typename T>
T expect(Result<T> result)
{
    if (!result) {
        give_up(std::string{name(result.error())});
    }
    return *std::move(result);
}

template <typename T>
T expect(Configured<T> made)
{
    if (!made) {
        give_up(text(made.error()));
    }
    return *std::move(made);
}

binary::DecodeLimits generous()
{
    binary::DecodeLimits limits = client::response_limits;
    limits.max_array_length = 1'000'000;
    return limits;
}

RelativePathElement element(std::string name)
{
    RelativePathElement result;
    result.reference_type_id = NodeId{0, id::HierarchicalReferences};
    result.include_subtypes = true;
    result.target_name = QualifiedName{1, String{std::move(name)}};
    return result;
}

} // namespace

struct Services::Impl {
    FixedClock clock;
    crypto::SystemRandom random;
    NullLog log;
    TimePoint now{};
    std::optional<server::Server> server;
    std::optional<server::Connection> connection;
    std::optional<client::Connection> client;
    double server_us{0};
    /// What the last response borrows from.
    client::ConnectionEvent last_event;

    void open(model::AddressSpace space);
    /// Carries bytes until the client has something to tell.
    client::ConnectionEvent wait();

    template <typename Response, typename Request>
    Response call(Request& request)
    {
        static_cast<void>(expect(client->send(request)));
        last_event = wait();
        return expect(last_event.response<Response>(generous()));
    }
};

void Services::Impl::open(model::AddressSpace space)
{
    server::ServerConfig config;
    config.endpoints = {{{}, true}};
    const server::ServerEnvironment environment{
        .random = &random, .wall_clock = &clock, .log = &log};
    server.emplace(
        expect(server::Server::create(std::move(config), environment, std::move(space))));
    connection.emplace(expect(server->connect("192.0.2.1", now)));
    client::ConnectionConfig wishes;
    wishes.channel.endpoint_url = "opc.tcp://localhost:4840";
    client.emplace(
        std::move(wishes),
        channel::ChannelEnvironment{.random = &random, .wall_clock = &clock, .log = &log}, now);
    if (const auto ready = wait(); ready.kind != client::ConnectionEvent::Kind::Ready) {
        give_up(std::string{name(ready.status)});
    }
}

client::ConnectionEvent Services::Impl::wait()
{
    for (;;) {
        if (auto event = client->next_event()) {
            return *std::move(event);
        }
        const std::vector<std::byte> request{client->output().begin(), client->output().end()};
        client->consume(request.size());
        const auto begin = Clock::now();
        static_cast<void>(connection->feed(request, now));
        while (connection->next_deadline() <= now) { // large requests are carried out in turns
            connection->handle_deadline(now);
        }
        server_us += elapsed_us(begin);
        if (request.empty() && connection->output().empty()) {
            give_up("Bad_Timeout");
        }
        static_cast<void>(client->feed(connection->output(), now));
        connection->consume(connection->output().size());
    }
}

Services::Services(model::AddressSpace space) : impl_{std::make_unique<Impl>()}
{
    impl_->open(std::move(space));
}

Services::~Services() = default;

const model::AddressSpace& Services::space() const
{
    return impl_->server->address_space();
}

Services::Cost Services::browse(const Wish& wish)
{
    Cost best{std::numeric_limits<double>::max(), 0};
    for (int i = 0; i < rounds; ++i) {
        impl_->server_us = 0;
        BrowseRequest request;
        request.requested_max_references_per_node = wish.page;
        BrowseDescription& wanted = request.nodes_to_browse.emplace_back();
        wanted.node_id = wish.node;
        wanted.reference_type_id = wish.type;
        wanted.include_subtypes = wish.include_subtypes;
        wanted.node_class_mask = wish.node_class_mask;
        wanted.result_mask = 63;
        const auto first = impl_->call<BrowseResponse>(request);
        std::size_t found = first.results[0].references.size();
        ByteString more{first.results[0].continuation_point.span()};
        while (!more.empty()) {
            BrowseNextRequest next;
            next.continuation_points.push_back(more);
            const auto response = impl_->call<BrowseNextResponse>(next);
            found += response.results[0].references.size();
            more = ByteString{response.results[0].continuation_point.span()};
        }
        best = {std::min(best.microseconds, impl_->server_us), found};
    }
    return best;
}

Services::Cost Services::translate(std::uint32_t count, std::uint32_t variables)
{
    TranslateBrowsePathsToNodeIdsRequest request;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto number = static_cast<std::uint32_t>(std::uint64_t{i} * variables / count);
        const std::string id = machine_variable(number).string().str();
        BrowsePath& path = request.browse_paths.emplace_back();
        path.starting_node = NodeId{0, id::ObjectsFolder};
        for (std::size_t begin = 0; begin < id.size();) {
            const std::size_t end = std::min(id.find('.', begin), id.size());
            path.relative_path.elements.push_back(element(id.substr(begin, end - begin)));
            begin = end + 1;
        }
    }
    Cost best{std::numeric_limits<double>::max(), 0};
    for (int i = 0; i < rounds; ++i) {
        impl_->server_us = 0;
        const auto response = impl_->call<TranslateBrowsePathsToNodeIdsResponse>(request);
        std::size_t found = 0;
        for (const BrowsePathResult& result : response.results) {
            found += result.targets.size();
        }
        best = {std::min(best.microseconds, impl_->server_us), found};
    }
    return best;
}

} // namespace busbar::bench
