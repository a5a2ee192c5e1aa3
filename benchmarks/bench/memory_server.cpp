#include "memory_server.hpp"

#include <chrono>
#include <ctime>
#include <string>
#include <utility>

#include <busbar/client/response_limits.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::bench {

namespace {

constexpr std::size_t plenty = 5'000'000;

/// Microseconds of processor time that this thread has had: what else the machine does does not
/// count.
double thread_time_us()
{
    std::timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) / 1e3;
}

server::ServerConfig open_config()
{
    server::ServerConfig config;
    config.endpoints = {{}};
    config.endpoints[0].allows_anonymous = true;
    config.endpoints[0].allows_user_name = false;
    server::ServerLimits& limits = config.limits;
    limits.max_connections = plenty;
    limits.max_connections_per_address = plenty;
    limits.max_sessions = plenty;
    limits.max_sessions_per_user = plenty;
    limits.subscriptions.max_subscriptions_per_user = limits.subscriptions.max_subscriptions;
    limits.subscriptions.max_items = plenty;
    limits.subscriptions.max_items_per_user = plenty;
    limits.subscriptions.max_items_per_subscription = plenty;
    limits.subscriptions.max_memory = std::size_t{16} << 30U;
    limits.subscriptions.max_subscription_memory = limits.subscriptions.max_memory;
    return config;
}

} // namespace

class MemoryServer::Clock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override
    {
        return DateTime::from_unix_seconds(1'800'000'000);
    }
};

template <typename Work>
void MemoryServer::timed(Work&& work)
{
    const double begin = thread_time_us();
    std::forward<Work>(work)();
    while (server_->next_changed()) {
    }
    if (server_->next_deadline() <= now_) {
        server_->handle_deadline(now_);
    }
    time_us_ += thread_time_us() - begin;
}

MemoryServer::MemoryServer() : clock_{std::make_unique<Clock>()}, source_{*clock_}
{
    const server::ServerEnvironment environment{
        .random = &random_, .wall_clock = clock_.get(), .log = &log_};
    server_.emplace(server::Server::create(open_config(), environment).value());
    server_->start(now_);
    source_index_ = server_->add_source(source_);
    namespace_index_ = server_->address_space().add_namespace("urn:busbar:bench").value();
}

MemoryServer::~MemoryServer() = default;

NodeId MemoryServer::node(std::size_t number) const
{
    return NodeId{namespace_index_, static_cast<std::uint32_t>(number)};
}

void MemoryServer::add_variables(std::size_t count)
{
    model::AddressSpace& space = server_->address_space();
    model::NewNode node;
    node.parent = space.find(id::ObjectsFolder);
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Double};
    variable.source = source_index_;
    timed([&] {
        for (; variables_ < count; ++variables_) {
            const std::string name = std::to_string(variables_);
            node.id = this->node(variables_);
            node.browse_name = QualifiedName{namespace_index_, String::borrow(name)};
            variable.handle = source_.add(Variant{static_cast<double>(variables_)});
            static_cast<void>(space.add_variable(node, variable).value());
        }
    });
}

Result<std::unique_ptr<Guest>> MemoryServer::admit()
{
    std::optional<server::Connection> connection;
    StatusCode refusal;
    timed([&] {
        auto made = server_->connect("192.0.2.1", now_);
        if (made) {
            connection.emplace(*std::move(made));
        } else {
            refusal = made.error();
        }
    });
    if (!connection) {
        return fail(refusal);
    }
    client::ConnectionConfig config;
    config.channel.endpoint_url = "opc.tcp://localhost:4840";
    const channel::ChannelEnvironment environment{
        .random = &random_, .wall_clock = clock_.get(), .log = &log_};
    std::unique_ptr<Guest> guest{new Guest{
        *this, *std::move(connection), client::Connection{std::move(config), environment, now_}}};
    if (const auto ready = guest->wait(); ready.kind != client::ConnectionEvent::Kind::Ready) {
        return fail(ready.status);
    }
    return guest;
}

double MemoryServer::take_time_us()
{
    return std::exchange(time_us_, 0);
}

Guest::Guest(MemoryServer& host, server::Connection connection, client::Connection client)
    : host_{&host}, connection_{std::move(connection)}, client_{std::move(client)}
{
}

binary::DecodeLimits Guest::generous()
{
    binary::DecodeLimits limits = client::response_limits;
    limits.max_array_length = 1'000'000;
    return limits;
}

client::ConnectionEvent Guest::wait()
{
    for (;;) {
        if (auto event = client_.next_event()) {
            return *std::move(event);
        }
        const std::vector<std::byte> request{client_.output().begin(), client_.output().end()};
        client_.consume(request.size());
        const bool is_late = connection_.next_deadline() <= host_->now_;
        if (request.empty() && connection_.output().empty() && !is_late) {
            return {client::ConnectionEvent::Kind::Closed, 0, StatusCode{status::Bad_Timeout}, {}};
        }
        host_->timed([&] {
            if (!request.empty()) {
                static_cast<void>(connection_.feed(request, host_->now_));
            }
            if (connection_.next_deadline() <= host_->now_) {
                connection_.handle_deadline(host_->now_);
            }
        });
        const std::vector<std::byte> response{connection_.output().begin(),
                                              connection_.output().end()};
        host_->timed([&] { connection_.consume(response.size()); });
        static_cast<void>(client_.feed(response, host_->now_));
    }
}

} // namespace busbar::bench
