#include <busbar/harness/bench.hpp>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/monitored_item.hpp>

namespace busbar::harness {

namespace {

constexpr int publish_requests = 2;
constexpr std::size_t max_values = 100'000;

ReadValueId value_of(const NodeId& node)
{
    ReadValueId item;
    item.node_id = node;
    item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    return item;
}

} // namespace

Bench::Bench(BenchOptions options)
    : own_world_{std::make_unique<World>(options.seed)}, world_{*own_world_},
      request_timeout_{options.client.request_timeout}, server_{world_, std::move(options.server),
                                                                options.server_parts},
      client_{world_, std::move(options.client), options.client_parts}
{
    static_cast<void>(server_.server()); // throws if there is none
}

Bench::Bench(World& world, BenchOptions options)
    : world_{world}, request_timeout_{options.client.request_timeout},
      server_{world_, std::move(options.server), options.server_parts},
      client_{world_, std::move(options.client), options.client_parts}
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

Result<void> Bench::connect()
{
    if (!client_.is_ready()) {
        lose(status::Bad_ConnectionClosed);
        if (const auto opened = client_.open(); !opened) {
            return opened;
        }
    }
    for (std::size_t i = 0; i < watched_.size(); ++i) {
        if (watched_[i].is_lost && watch(i).is_good()) {
            watched_[i].is_lost = false;
        }
    }
    return {};
}

void Bench::Watched::add(DataValue value)
{
    if (values.size() == max_values) {
        values.erase(values.begin());
    }
    values.push_back(std::move(value));
}

DataValue Bench::read(const NodeId& node)
{
    const auto values = read(std::vector{node});
    return values ? (*values)[0] : DataValue{values.error()};
}

Result<Array<DataValue>> Bench::read(const std::vector<NodeId>& nodes)
{
    if (const auto connected = connect(); !connected) {
        return fail(connected.error());
    }
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Both;
    for (const NodeId& node : nodes) {
        request.nodes_to_read.push_back(value_of(node));
    }
    auto response = client_.call<ReadResponse>(std::move(request));
    if (!response) {
        return fail(response.error());
    }
    if (response->results.size() != nodes.size()) {
        return fail(status::Bad_UnknownResponse);
    }
    return std::move(response->results);
}

StatusCode Bench::write(const NodeId& node, Variant value)
{
    if (const auto connected = connect(); !connected) {
        return connected.error();
    }
    WriteRequest request;
    WriteValue& item = request.nodes_to_write.emplace_back();
    item.node_id = node;
    item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    item.value = DataValue{std::move(value)};
    const auto response = client_.call<WriteResponse>(std::move(request));
    if (!response) {
        return response.error();
    }
    return response->results.size() == 1 ? response->results[0] : status::Bad_UnknownResponse;
}

Result<CallMethodResult> Bench::call(const NodeId& object, const NodeId& method,
                                     Array<Variant> arguments)
{
    if (const auto connected = connect(); !connected) {
        return fail(connected.error());
    }
    CallRequest request;
    CallMethodRequest& item = request.methods_to_call.emplace_back();
    item.object_id = object;
    item.method_id = method;
    item.input_arguments = std::move(arguments);
    auto response = client_.call<CallResponse>(std::move(request));
    if (!response) {
        return fail(response.error());
    }
    if (response->results.size() != 1) {
        return fail(status::Bad_UnknownResponse);
    }
    return std::move(response->results[0]);
}

Result<std::uint32_t> Bench::subscription(Duration interval)
{
    if (const auto found = subscriptions_.find(interval); found != subscriptions_.end()) {
        return found->second;
    }
    if (interval <= Duration{0} || publish_requests * interval >= request_timeout_) {
        return fail(status::Bad_InvalidArgument);
    }
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = to_milliseconds(interval);
    request.requested_lifetime_count = 10'000;
    // Each of the Publish requests has its turn before its timeout.
    const Duration keep_alive = request_timeout_ / (2 * publish_requests);
    request.requested_max_keep_alive_count =
        static_cast<std::uint32_t>(std::max<Duration::rep>(keep_alive / interval, 1));
    request.publishing_enabled = true;
    const auto response = client_.call<CreateSubscriptionResponse>(std::move(request));
    if (!response) {
        return fail(response.error());
    }
    subscriptions_[interval] = response->subscription_id;
    return response->subscription_id;
}

StatusCode Bench::subscribe(const NodeId& node, Duration interval, std::uint32_t queue_size)
{
    if (const auto connected = connect(); !connected) {
        return connected.error();
    }
    watched_.push_back({node, interval, queue_size, false, {}});
    const StatusCode result = watch(watched_.size() - 1);
    if (result.is_bad()) {
        watched_.pop_back();
    }
    return result;
}

StatusCode Bench::watch(std::size_t index)
{
    const Watched watched = watched_[index];
    const auto subscription_id = subscription(watched.interval);
    if (!subscription_id) {
        return subscription_id.error();
    }
    CreateMonitoredItemsRequest request;
    request.subscription_id = *subscription_id;
    request.timestamps_to_return = TimestampsToReturn::Both;
    MonitoredItemCreateRequest& item = request.items_to_create.emplace_back();
    item.item_to_monitor = value_of(watched.node);
    item.monitoring_mode = MonitoringMode::Reporting;
    item.requested_parameters.client_handle = static_cast<std::uint32_t>(index);
    item.requested_parameters.sampling_interval = to_milliseconds(watched.interval);
    item.requested_parameters.queue_size = watched.queue_size;
    item.requested_parameters.discard_oldest = true;
    const auto response = client_.call<CreateMonitoredItemsResponse>(std::move(request));
    if (!response) {
        return response.error();
    }
    while (publishing_ < publish_requests) {
        publish();
    }
    return response->results.size() == 1 ? response->results[0].status_code
                                         : status::Bad_UnknownResponse;
}

void Bench::lose(StatusCode why)
{
    subscriptions_.clear();
    acknowledgements_.clear();
    for (Watched& watched : watched_) {
        if (!std::exchange(watched.is_lost, true)) {
            watched.add(DataValue{why});
        }
    }
}

void Bench::publish()
{
    PublishRequest request;
    for (const SubscriptionAcknowledgement& one : std::exchange(acknowledgements_, {})) {
        request.subscription_acknowledgements.push_back(one);
    }
    ++publishing_;
    client_.send<PublishResponse>(std::move(request), [this](Result<PublishResponse> response) {
        --publishing_;
        published(response);
    });
}

void Bench::published(const Result<PublishResponse>& response)
{
    if (!response) {
        if (client_.is_ready() && response.error() == status::Bad_Timeout) {
            publish(); // nothing happened for this long
        } else {
            lose(response.error());
        }
        return;
    }
    for (const ExtensionObject& data : response->notification_message.notification_data) {
        if (const auto* const change = data.get_if<StatusChangeNotification>()) {
            lose(change->status);
        }
        const auto* const changes = data.get_if<DataChangeNotification>();
        if (changes == nullptr) {
            continue;
        }
        acknowledgements_.push_back(
            {response->subscription_id, response->notification_message.sequence_number});
        for (const MonitoredItemNotification& change : changes->monitored_items) {
            if (change.client_handle < watched_.size()) {
                watched_[change.client_handle].add(change.value);
            }
        }
    }
    publish();
}

std::vector<DataValue> Bench::values(const NodeId& node)
{
    std::vector<DataValue> values;
    bool is_watched = false;
    for (Watched& watched : watched_) {
        if (watched.node == node) {
            is_watched = true;
            for (DataValue& value : std::exchange(watched.values, {})) {
                values.push_back(std::move(value));
            }
        }
    }
    if (!is_watched) {
        throw std::invalid_argument{"values(): subscribe() has not been called for " +
                                    to_string(node)};
    }
    return values;
}

} // namespace busbar::harness
