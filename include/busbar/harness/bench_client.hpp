#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <busbar/client/event_filter.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/harness/connection_host.hpp>
#include <busbar/harness/text.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

namespace busbar::harness {

/// An Event that a client of a bench got.
struct BUSBAR_API BenchEvent {
    /// If bad, the Subscription has ended for this reason, and there are no fields.
    StatusCode status{};
    /// The fields have the names that were asked for.
    std::map<std::string, Variant, std::less<>> fields{};

    /// Returns a field, null if the Event does not have it or tells of the end of a Subscription.
    /// Throws std::invalid_argument if it was not asked for.
    [[nodiscard]] const Variant& operator[](std::string_view name) const;
    /// The text of the field Message; empty if there is none.
    [[nodiscard]] std::string message() const;
};
/// "Message LocalizedText \"too full\", Severity UInt16 700".
[[nodiscard]] BUSBAR_API std::string text_of(const BenchEvent& event);

namespace detail {

/// Says whether a value is what a test waits for: a matcher of the framework, a function of the
/// value, or a value that it holds with status Good.
template <typename Wanted>
bool is_wanted(const Wanted& wanted, const DataValue& value)
{
    if constexpr (std::is_invocable_r_v<bool, const Wanted&, const DataValue&>) {
        return wanted(value);
    } else if constexpr (requires { wanted.match(value); }) {
        return wanted.match(value);
    } else if constexpr (std::is_constructible_v<Variant, const Wanted&>) {
        return value.status.is_good() && value.value == Variant{wanted};
    } else {
        return value == wanted;
    }
}

/// Says what is_wanted() looks for, after "a value that".
template <typename Wanted>
std::string text_of_wanted(const Wanted& wanted)
{
    if constexpr (requires { std::string{wanted.describe()}; }) {
        return wanted.describe();
    } else if constexpr (requires { Variant{wanted.value}; }) {
        return "holds " + text_of(Variant{wanted.value});
    } else if constexpr (std::is_constructible_v<Variant, const Wanted&>) {
        return "holds " + text_of(Variant{wanted});
    } else {
        return "satisfies the test's condition";
    }
}

} // namespace detail

/// A client of a bench: a session with the server, and verbs. It connects with the first verb that
/// needs it, and again if it has lost its connection meanwhile. Verbs run the world until they are
/// done. One thread; the world must outlive it.
class BUSBAR_API BenchClient {
public:
    BenchClient(World& world, client::ConnectionConfig config, const ClientParts& parts);
    BenchClient(const BenchClient&) = delete;
    BenchClient& operator=(const BenchClient&) = delete;

    /// The client itself, to send what there is no verb for, to close or to drop it.
    [[nodiscard]] ConnectionHost& host() { return host_; }

    /// Connects and logs in if there is no session, also after a loss.
    Result<void> connect();
    /// Connects, sends a request of any service and returns its response; errors as
    /// ConnectionHost::call().
    template <typename Response, typename Request>
    [[nodiscard]] Result<Response> call(Request request)
    {
        if (const auto connected = connect(); !connected) {
            return fail(connected.error());
        }
        return host_.call<Response>(std::move(request));
    }

    /// Reads an attribute with both timestamps; a DataValue with the status if the service fails.
    [[nodiscard]] DataValue read(const NodeId& node, AttributeId attribute = AttributeId::Value);
    /// Reads the values of all nodes in one request.
    [[nodiscard]] Result<Array<DataValue>> read(const std::vector<NodeId>& nodes);
    /// Writes a value, and returns the result.
    StatusCode write(const NodeId& node, Variant value);
    /// Calls a Method.
    [[nodiscard]] Result<CallMethodResult> call(const NodeId& object, const NodeId& method,
                                                Array<Variant> arguments = {});

    /// Watches the value, with a Subscription that publishes and samples at `interval`. The first
    /// value is among values() after a while. If the connection or the Subscription is lost, a
    /// value with the reason as its status is added to values(), and the next verb watches the node
    /// again. Bad_InvalidArgument for an interval of half the client's request_timeout or more; the
    /// world's log says so.
    StatusCode subscribe(const NodeId& node, Duration interval = std::chrono::milliseconds{100},
                         std::uint32_t queue_size = 100);
    /// The values of a watched node since the last call; at most the last 100,000. Throws
    /// std::invalid_argument if the node is not watched.
    [[nodiscard]] std::vector<DataValue> values(const NodeId& node);
    /// Runs the world until a value of the node is `wanted`, and returns that value. It and those
    /// before it are no longer among values(). A node that is not watched is watched with the
    /// defaults of subscribe(); a lost connection is made again. `wanted` is a value,
    /// await(level, 42.0); a matcher, await(level, holds(42.0)); or a function of a DataValue.
    /// Throws std::runtime_error, which says what came, if `limit` is over first, or if the node
    /// cannot be watched.
    template <typename Wanted>
    DataValue await(const NodeId& node, const Wanted& wanted,
                    Duration limit = std::chrono::minutes{1})
    {
        return await_value(
            node, [&](const DataValue& value) { return detail::is_wanted(wanted, value); },
            detail::text_of_wanted(wanted), limit);
    }

    /// Watches the Events of a node, which publishes them at `interval`; at a loss as subscribe().
    StatusCode subscribe_events(const NodeId& notifier,
                                const client::EventSelection& selection = {},
                                Duration interval = std::chrono::milliseconds{100});
    /// The Events of a node since the last call; at most the last 100,000. Throws
    /// std::invalid_argument if they are not watched.
    [[nodiscard]] std::vector<BenchEvent> events(const NodeId& notifier);
    /// Runs the world until there is an Event for which `wanted` is true, and returns it, as
    /// await() does. The node's Events are watched with the defaults of subscribe_events() if they
    /// are not.
    BenchEvent await_event(const NodeId& notifier, FunctionRef<bool(const BenchEvent&)> wanted,
                           Duration limit = std::chrono::minutes{1})
    {
        return await_one(notifier, wanted, "satisfies the test's condition", limit);
    }
    /// The same for an Event with this Message.
    BenchEvent await_event(const NodeId& notifier, std::string_view message,
                           Duration limit = std::chrono::minutes{1});

private:
    enum class Kind : std::uint8_t { Value, Events };
    struct Watched {
        Kind kind{Kind::Value};
        NodeId node;
        Duration interval{0};
        std::uint32_t queue_size{0};
        client::EventSelection selection;
        bool is_lost{false};
        std::vector<DataValue> values;
        std::vector<BenchEvent> events;
        /// Differs for each creation of the item: a Subscription that the client has given up may
        /// still send notifications.
        std::uint32_t handle{0};
    };

    [[nodiscard]] Result<Array<DataValue>> read(ReadRequest request);
    DataValue await_value(const NodeId& node, FunctionRef<bool(const DataValue&)> is_wanted,
                          std::string_view wanted, Duration limit);
    BenchEvent await_one(const NodeId& notifier, FunctionRef<bool(const BenchEvent&)> is_wanted,
                         std::string_view wanted, Duration limit);
    /// Returns the first of the node's that is wanted and takes it and those before it; throws if
    /// none comes in time.
    template <typename Item>
    Item await_item(const NodeId& node, FunctionRef<bool(const Item&)> is_wanted,
                    std::string_view wanted, Duration limit);
    /// Runs the world until `is_done`, and connects again meanwhile.
    bool run_until(FunctionRef<bool()> is_done, Duration limit);
    Result<void> connect_within(Duration limit);
    [[nodiscard]] bool is_watched(Kind kind, const NodeId& node) const;
    [[nodiscard]] bool is_any_lost() const;
    /// Throws unless the node is watched.
    void need_watched(Kind kind, const NodeId& node, std::string_view verb) const;
    StatusCode add(Watched watched);
    /// Creates the item of a watched node, which is no longer lost if that succeeds.
    StatusCode watch(std::size_t index);
    /// Returns the watched node whose item has this client handle; null if there is none.
    [[nodiscard]] Watched* watched_with(std::uint32_t handle);
    /// Returns the status of the first field that the server does not know, and tells which it is.
    [[nodiscard]] StatusCode bad_field(const ExtensionObject& filter_result,
                                       const client::EventSelection& selection);
    /// All Subscriptions have ended.
    void lose(StatusCode why);

    [[nodiscard]] Result<std::uint32_t> subscription(Duration interval);
    void publish();
    void published(const Result<PublishResponse>& response);
    void received(const ExtensionObject& data);
    void tell(const std::string& text) { log_.write(LogLevel::Warning, "bench", text); }

    World& world_;
    Duration request_timeout_;
    LogSink& log_;
    ConnectionHost host_;
    /// The Subscriptions of this connection's session, by publishing interval.
    std::map<Duration, std::uint32_t> subscriptions_;
    std::vector<Watched> watched_;
    std::uint32_t last_handle_{0};
    std::vector<SubscriptionAcknowledgement> acknowledgements_;
    int publishing_{0};
};

} // namespace busbar::harness
