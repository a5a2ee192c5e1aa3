#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/harness/bench_client.hpp>
#include <busbar/harness/server_host.hpp>

namespace busbar::harness {

/// The settings of a bench.
struct BenchOptions {
    std::uint64_t seed{World::seed_from_environment()};
    server::ServerConfig server{open_server_config()};
    ServerParts server_parts{};
    client::ConnectionConfig client{open_connection_config()};
    ClientParts client_parts{};
};

/// A server, a client with a session, and verbs: the beginning of a test of a data source or an
/// address space. The client connects with the first verb that needs it, and again if it has lost
/// its connection meanwhile. Verbs run the world until they are done. One thread.
class BUSBAR_API Bench {
public:
    /// Throws std::logic_error with the problem if the server cannot be made as configured.
    explicit Bench(BenchOptions options = {});
    /// In a world that exists, such as a RealWorld, and outlives the bench; the seed is that one's.
    explicit Bench(World& world, BenchOptions options = {});

    [[nodiscard]] World& world() { return world_; }
    [[nodiscard]] ServerHost& host() { return server_; }
    [[nodiscard]] server::Server& server() { return server_.server(); }
    [[nodiscard]] ConnectionHost& client() { return first_.host(); }
    /// The users of the server, unless BenchOptions::server_parts has others.
    [[nodiscard]] TestUsers& users() { return server_.users(); }
    /// Returns the further client of this name, which is made when it is first asked for: with the
    /// options of the first client, but a log and an address of its own, 192.0.2.2 and following,
    /// for Network::weather_of(). The world's log and trace have its lines under its name. It lives
    /// as long as the bench.
    BenchClient& client(std::string_view name);
    /// Makes a further client with options of its own. If its address is the default or the first
    /// client's, it gets one as a client() does. Throws std::invalid_argument if there is one of
    /// this name.
    BenchClient& add_client(std::string name, client::ConnectionConfig config,
                            ClientParts parts = {});
    /// Makes a further client with the options of the first one for this user and this security,
    /// and logs it in. It trusts the server's own certificate and has, where it needs one and the
    /// options have none, default_client_identity(). Its name is that of the user, "anonymous",
    /// "certificate" or "issued", with a number from the second one on. Throws std::runtime_error
    /// with the status if the server refuses it.
    BenchClient& log_in(client::UserIdentity user = {}, channel::SecuritySetting security = {});

    /// Creates a data source and adds it to the server. It lives as long as the server needs it,
    /// which a member of a class derived from Bench would not.
    template <typename Source, typename... Arguments>
    Source& make_source(Arguments&&... arguments)
    {
        auto made = std::make_unique<Source>(std::forward<Arguments>(arguments)...);
        Source& source = *made;
        owned_.push_back(std::move(made));
        server_.add_source(source);
        return source;
    }
    /// Adds a Variable "ns=1;s=<name>" below Objects, which clients may write unless `access` says
    /// otherwise: add_variable("Level", source.variable(handle, 0.0)), or with a value alone.
    /// Errors as AddressSpace::add_variable.
    Result<NodeId> add_variable(std::string_view name, const model::BoundValue& value,
                                model::Access access = model::Access::ReadWrite);

    /// Lets virtual time pass.
    void run_for(Duration time) { world_.run_for(time); }

    // The verbs of the first client; see BenchClient.

    /// Connects and logs in if there is no session, also after a loss.
    Result<void> connect() { return first_.connect(); }
    /// Sends a request of any service and returns its response.
    template <typename Response, typename Request>
    [[nodiscard]] Result<Response> call(Request request)
    {
        return first_.call<Response>(std::move(request));
    }
    /// Reads an attribute with both timestamps.
    [[nodiscard]] DataValue read(const NodeId& node, AttributeId attribute = AttributeId::Value)
    {
        return first_.read(node, attribute);
    }
    /// Reads the values of all nodes in one request.
    [[nodiscard]] Result<Array<DataValue>> read(const std::vector<NodeId>& nodes)
    {
        return first_.read(nodes);
    }
    /// Writes a value, and returns the result.
    StatusCode write(const NodeId& node, Variant value)
    {
        return first_.write(node, std::move(value));
    }
    /// Calls a Method.
    [[nodiscard]] Result<CallMethodResult> call(const NodeId& object, const NodeId& method,
                                                Array<Variant> arguments = {})
    {
        return first_.call(object, method, std::move(arguments));
    }
    /// Watches the value.
    StatusCode subscribe(const NodeId& node, Duration interval = std::chrono::milliseconds{100},
                         std::uint32_t queue_size = 100)
    {
        return first_.subscribe(node, interval, queue_size);
    }
    /// The values of a watched node since the last call.
    [[nodiscard]] std::vector<DataValue> values(const NodeId& node) { return first_.values(node); }
    /// Runs the world until a value of the node is `wanted`, and returns that value.
    template <typename Wanted>
    DataValue await(const NodeId& node, const Wanted& wanted,
                    Duration limit = std::chrono::minutes{1})
    {
        return first_.await(node, wanted, limit);
    }
    /// Watches the Events of a node.
    StatusCode subscribe_events(const NodeId& notifier,
                                const client::EventSelection& selection = {},
                                Duration interval = std::chrono::milliseconds{100})
    {
        return first_.subscribe_events(notifier, selection, interval);
    }
    /// The Events of a node since the last call.
    [[nodiscard]] std::vector<BenchEvent> events(const NodeId& notifier)
    {
        return first_.events(notifier);
    }
    /// Runs the world until there is an Event with this Message, or for which a function is true.
    template <typename Wanted>
    BenchEvent await_event(const NodeId& notifier, const Wanted& wanted,
                           Duration limit = std::chrono::minutes{1})
    {
        return first_.await_event(notifier, wanted, limit);
    }

private:
    Bench(std::unique_ptr<World> world, BenchOptions options);

    std::unique_ptr<World> own_world_;
    World& world_;
    client::ConnectionConfig client_config_;
    ClientParts client_parts_;
    std::vector<std::unique_ptr<server::DataSource>> owned_;
    ServerHost server_;
    BenchClient first_;
    std::map<std::string, std::unique_ptr<BenchClient>, std::less<>> further_;
};

} // namespace busbar::harness
