#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/harness/connection_host.hpp>
#include <busbar/harness/server_host.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/subscription.hpp>

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
    [[nodiscard]] ConnectionHost& client() { return client_; }

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

    /// Connects and logs in if there is no session, also after a loss.
    Result<void> connect();
    /// Lets virtual time pass.
    void run_for(Duration time) { world_.run_for(time); }

    /// Reads the Value attribute with both timestamps; a DataValue with the status if the service
    /// fails.
    [[nodiscard]] DataValue read(const NodeId& node);
    /// Reads all nodes in one request.
    [[nodiscard]] Result<Array<DataValue>> read(const std::vector<NodeId>& nodes);
    /// Writes a value, and returns the result.
    StatusCode write(const NodeId& node, Variant value);
    /// Calls a Method.
    [[nodiscard]] Result<CallMethodResult> call(const NodeId& object, const NodeId& method,
                                                Array<Variant> arguments = {});

    /// Watches the value, with a Subscription that publishes and samples at `interval`. The first
    /// value is among values() after a while. If the connection or the Subscription is lost, a
    /// value with the reason as its status is added to values(), and the next verb watches the node
    /// again. Bad_InvalidArgument for an interval of half the client's request_timeout or more.
    StatusCode subscribe(const NodeId& node, Duration interval = std::chrono::milliseconds{100},
                         std::uint32_t queue_size = 100);
    /// The values of a watched node since the last call; at most the last 100,000. Throws
    /// std::invalid_argument if subscribe() has not been called for the node.
    [[nodiscard]] std::vector<DataValue> values(const NodeId& node);

private:
    struct Watched {
        NodeId node;
        Duration interval{0};
        std::uint32_t queue_size{0};
        bool is_lost{false};
        std::vector<DataValue> values;

        void add(DataValue value);
    };

    /// Creates the item of a watched node.
    StatusCode watch(std::size_t index);
    /// All Subscriptions have ended.
    void lose(StatusCode why);

    [[nodiscard]] Result<std::uint32_t> subscription(Duration interval);
    void publish();
    void published(const Result<PublishResponse>& response);

    std::unique_ptr<World> own_world_;
    World& world_;
    Duration request_timeout_;
    std::vector<std::unique_ptr<server::DataSource>> owned_;
    ServerHost server_;
    ConnectionHost client_;
    /// The Subscriptions of this connection's session, by publishing interval.
    std::map<Duration, std::uint32_t> subscriptions_;
    /// The client handle is the index.
    std::vector<Watched> watched_;
    std::vector<SubscriptionAcknowledgement> acknowledgements_;
    int publishing_{0};
};

} // namespace busbar::harness
