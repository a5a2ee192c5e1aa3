#include <busbar/harness/bench_client.hpp>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include <busbar/core/attribute_id.hpp>
#include <busbar/harness/report.hpp>
#include <busbar/types/filter.hpp>

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

ClientParts with_log(ClientParts parts, LogSink& log)
{
    parts.log = &log;
    return parts;
}

template <typename Item>
void add_to(std::vector<Item>& items, Item item)
{
    if (items.size() == max_values) {
        items.erase(items.begin());
    }
    items.push_back(std::move(item));
}

} // namespace

const Variant& BenchEvent::operator[](std::string_view name) const
{
    static const Variant null;
    if (fields.empty()) {
        return null;
    }
    const auto found = fields.find(name);
    if (found == fields.end()) {
        throw std::invalid_argument{"the field " + std::string{name} +
                                    " has not been asked for: " + text_of(*this)};
    }
    return found->second;
}

std::string BenchEvent::message() const
{
    const auto found = fields.find("Message");
    const auto* const text =
        found == fields.end() ? nullptr : found->second.get_if<LocalizedText>();
    return text == nullptr ? std::string{} : std::string{text->text.view()};
}

std::string text_of(const BenchEvent& event)
{
    std::string text = event.status.is_bad() ? text_of(event.status) : std::string{};
    for (const auto& [name, value] : event.fields) {
        text += (text.empty() ? "" : ", ") + name + " " + text_of(value);
    }
    return text;
}

BenchClient::BenchClient(World& world, client::ConnectionConfig config, const ClientParts& parts)
    : world_{world}, request_timeout_{config.request_timeout},
      log_{parts.log != nullptr ? *parts.log : world.new_log(Actor::Client)},
      host_{world, std::move(config), with_log(parts, log_)}
{
}

Result<void> BenchClient::connect()
{
    return connect_within(std::chrono::minutes{1});
}

Result<void> BenchClient::connect_within(Duration limit)
{
    if (!host_.is_ready()) {
        lose(status::Bad_ConnectionClosed);
        if (const auto opened = host_.open(limit); !opened) {
            return opened;
        }
    }
    for (std::size_t i = 0; i < watched_.size(); ++i) {
        if (watched_[i].is_lost) {
            static_cast<void>(watch(i)); // tried again with the next verb
        }
    }
    return {};
}

DataValue BenchClient::read(const NodeId& node, AttributeId attribute)
{
    ReadRequest request;
    ReadValueId& item = request.nodes_to_read.emplace_back(value_of(node));
    item.attribute_id = static_cast<std::uint32_t>(attribute);
    const auto values = read(std::move(request));
    return values ? (*values)[0] : DataValue{values.error()};
}

Result<Array<DataValue>> BenchClient::read(const std::vector<NodeId>& nodes)
{
    ReadRequest request;
    for (const NodeId& node : nodes) {
        request.nodes_to_read.push_back(value_of(node));
    }
    return read(std::move(request));
}

Result<Array<DataValue>> BenchClient::read(ReadRequest request)
{
    const std::size_t count = request.nodes_to_read.size();
    request.timestamps_to_return = TimestampsToReturn::Both;
    auto response = call<ReadResponse>(std::move(request));
    if (!response) {
        return fail(response.error());
    }
    if (response->results.size() != count) {
        return fail(status::Bad_UnknownResponse);
    }
    return std::move(response->results);
}

StatusCode BenchClient::write(const NodeId& node, Variant value)
{
    if (const auto connected = connect(); !connected) {
        return connected.error();
    }
    WriteRequest request;
    WriteValue& item = request.nodes_to_write.emplace_back();
    item.node_id = node;
    item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    item.value = DataValue{std::move(value)};
    const auto response = host_.call<WriteResponse>(std::move(request));
    if (!response) {
        return response.error();
    }
    return response->results.size() == 1 ? response->results[0] : status::Bad_UnknownResponse;
}

Result<CallMethodResult> BenchClient::call(const NodeId& object, const NodeId& method,
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
    auto response = host_.call<CallResponse>(std::move(request));
    if (!response) {
        return fail(response.error());
    }
    if (response->results.size() != 1) {
        return fail(status::Bad_UnknownResponse);
    }
    return std::move(response->results[0]);
}

Result<std::uint32_t> BenchClient::subscription(Duration interval)
{
    if (const auto found = subscriptions_.find(interval); found != subscriptions_.end()) {
        return found->second;
    }
    if (interval <= Duration{0} || publish_requests * interval >= request_timeout_) {
        tell("an interval of " + text_of(interval) + " must be above 0 s and below " +
             text_of(request_timeout_ / publish_requests) +
             ", half of the client's request_timeout");
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
    const auto response = host_.call<CreateSubscriptionResponse>(std::move(request));
    if (!response) {
        return fail(response.error());
    }
    subscriptions_[interval] = response->subscription_id;
    return response->subscription_id;
}

StatusCode BenchClient::subscribe(const NodeId& node, Duration interval, std::uint32_t queue_size)
{
    return add({Kind::Value, node, interval, queue_size, {}, false, {}, {}, 0});
}

StatusCode BenchClient::subscribe_events(const NodeId& notifier,
                                         const client::EventSelection& selection, Duration interval)
{
    return add({Kind::Events, notifier, interval, 10'000, selection, false, {}, {}, 0});
}

StatusCode BenchClient::add(Watched watched)
{
    if (const auto connected = connect(); !connected) {
        return connected.error();
    }
    watched_.push_back(std::move(watched));
    const StatusCode result = watch(watched_.size() - 1);
    if (result.is_bad()) {
        watched_.pop_back();
    }
    return result;
}

StatusCode BenchClient::watch(std::size_t index)
{
    Watched& watched = watched_[index];
    const client::EventSelection selection = watched.selection;
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
    watched.handle = ++last_handle_;
    item.requested_parameters.client_handle = watched.handle;
    item.requested_parameters.queue_size = watched.queue_size;
    item.requested_parameters.discard_oldest = true;
    if (watched.kind == Kind::Events) {
        item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::EventNotifier);
        item.requested_parameters.filter =
            ExtensionObject::from(client::event_filter(watched.selection));
    } else {
        item.requested_parameters.sampling_interval = to_milliseconds(watched.interval);
    }
    const auto response = host_.call<CreateMonitoredItemsResponse>(std::move(request));
    if (!response) {
        return response.error();
    }
    if (response->results.size() != 1) {
        return status::Bad_UnknownResponse;
    }
    const MonitoredItemCreateResult& created = response->results[0];
    const StatusCode field = bad_field(created.filter_result, selection);
    if (created.status_code.is_good() && field.is_bad()) {
        DeleteMonitoredItemsRequest removal;
        removal.subscription_id = *subscription_id;
        removal.monitored_item_ids = {created.monitored_item_id};
        static_cast<void>(host_.call<DeleteMonitoredItemsResponse>(std::move(removal)));
        return field;
    }
    if (created.status_code.is_good()) {
        watched_[index].is_lost = false; // before publish(), which may lose it at once
    }
    // One that cannot be sent has failed already, and is not repeated.
    for (int missing = publish_requests - publishing_; missing > 0; --missing) {
        publish();
    }
    return created.status_code;
}

StatusCode BenchClient::bad_field(const ExtensionObject& filter_result,
                                  const client::EventSelection& selection)
{
    const auto* const result = filter_result.get_if<EventFilterResult>();
    for (std::size_t i = 0; result != nullptr && i < result->select_clause_results.size(); ++i) {
        if (const StatusCode status = result->select_clause_results[i];
            status.is_bad() && i < selection.fields.size()) {
            tell("Events do not have the field " + selection.fields[i] + ": " + text_of(status));
            return status;
        }
    }
    return status::Good;
}

void BenchClient::lose(StatusCode why)
{
    subscriptions_.clear();
    acknowledgements_.clear();
    for (Watched& watched : watched_) {
        if (std::exchange(watched.is_lost, true)) {
            continue;
        }
        if (watched.kind == Kind::Value) {
            add_to(watched.values, DataValue{why});
        } else {
            add_to(watched.events, BenchEvent{why, {}});
        }
    }
}

void BenchClient::publish()
{
    PublishRequest request;
    for (const SubscriptionAcknowledgement& one : std::exchange(acknowledgements_, {})) {
        request.subscription_acknowledgements.push_back(one);
    }
    ++publishing_;
    host_.send<PublishResponse>(std::move(request),
                                [this](const Result<PublishResponse>& response) {
                                    --publishing_;
                                    published(response);
                                });
}

void BenchClient::published(const Result<PublishResponse>& response)
{
    if (!response) {
        if (host_.is_ready() && response.error() == status::Bad_Timeout) {
            publish(); // nothing happened for this long
        } else {
            lose(response.error());
        }
        return;
    }
    const NotificationMessage& message = response->notification_message;
    if (!message.notification_data.empty()) { // not a keep-alive
        acknowledgements_.push_back({response->subscription_id, message.sequence_number});
    }
    for (const ExtensionObject& data : message.notification_data) {
        received(data);
    }
    publish();
}

void BenchClient::received(const ExtensionObject& data)
{
    if (const auto* const change = data.get_if<StatusChangeNotification>()) {
        lose(change->status);
    }
    if (const auto* const changes = data.get_if<DataChangeNotification>()) {
        for (const MonitoredItemNotification& change : changes->monitored_items) {
            if (Watched* const watched = watched_with(change.client_handle)) {
                add_to(watched->values, change.value);
            }
        }
    }
    if (const auto* const list = data.get_if<EventNotificationList>()) {
        for (const EventFieldList& event : list->events) {
            Watched* const watched = watched_with(event.client_handle);
            if (watched == nullptr) {
                continue;
            }
            BenchEvent known;
            for (std::size_t i = 0; i < watched->selection.fields.size(); ++i) {
                known.fields[watched->selection.fields[i]] =
                    i < event.event_fields.size() ? event.event_fields[i] : Variant{};
            }
            add_to(watched->events, std::move(known));
        }
    }
}

BenchClient::Watched* BenchClient::watched_with(std::uint32_t handle)
{
    const auto found = std::ranges::find(watched_, handle, &Watched::handle);
    return found == watched_.end() ? nullptr : &*found;
}

bool BenchClient::is_watched(Kind kind, const NodeId& node) const
{
    return std::any_of(watched_.begin(), watched_.end(), [&](const Watched& watched) {
        return watched.kind == kind && watched.node == node;
    });
}

bool BenchClient::is_any_lost() const
{
    return !host_.is_ready() || std::any_of(watched_.begin(), watched_.end(), //
                                            [](const Watched& watched) { return watched.is_lost; });
}

void BenchClient::need_watched(Kind kind, const NodeId& node, std::string_view verb) const
{
    if (!is_watched(kind, node)) {
        throw std::invalid_argument{std::string{verb} + " has not been called for " +
                                    to_string(node)};
    }
}

std::vector<DataValue> BenchClient::values(const NodeId& node)
{
    need_watched(Kind::Value, node, "values(): subscribe()");
    std::vector<DataValue> values;
    for (Watched& watched : watched_) {
        if (watched.kind == Kind::Value && watched.node == node) {
            std::ranges::move(std::exchange(watched.values, {}), std::back_inserter(values));
        }
    }
    return values;
}

std::vector<BenchEvent> BenchClient::events(const NodeId& notifier)
{
    need_watched(Kind::Events, notifier, "events(): subscribe_events()");
    std::vector<BenchEvent> events;
    for (Watched& watched : watched_) {
        if (watched.kind == Kind::Events && watched.node == notifier) {
            std::ranges::move(std::exchange(watched.events, {}), std::back_inserter(events));
        }
    }
    return events;
}

bool BenchClient::run_until(FunctionRef<bool()> is_done, Duration limit)
{
    constexpr Duration pause = std::chrono::seconds{1};
    const TimePoint end = world_.now() + limit;
    bool done = is_done();
    while (!done && world_.now() < end) {
        const bool has_connected = connect_within(end - world_.now()).has_value();
        const Duration left = end - world_.now();
        if (has_connected && !is_any_lost()) {
            static_cast<void>(world_.run_until(
                [&] {
                    done = is_done();
                    return done || is_any_lost();
                },
                left));
        } else if (done = is_done(); !done && left > Duration{0}) {
            world_.run_for(std::min(pause, left));
        }
    }
    return done || is_done();
}

template <typename Item>
Item BenchClient::await_item(const NodeId& node, FunctionRef<bool(const Item&)> is_wanted,
                             std::string_view wanted, Duration limit)
{
    constexpr bool is_value = std::is_same_v<Item, DataValue>;
    constexpr Kind kind = is_value ? Kind::Value : Kind::Events;
    const auto items_of = [](Watched& watched) -> std::vector<Item>& {
        if constexpr (is_value) {
            return watched.values;
        } else {
            return watched.events;
        }
    };
    const TimePoint begin = world_.now();
    if (!is_watched(kind, node)) {
        const auto connected = connect_within(limit);
        const StatusCode result = !connected ? connected.error()
                                  : is_value ? subscribe(node)
                                             : subscribe_events(node);
        if (result.is_bad()) {
            throw std::runtime_error{to_string(node) + " cannot be watched: " + text_of(result) +
                                     "\n" + account_of_worlds()};
        }
    }
    Item found;
    std::size_t count = 0;
    std::string last;
    // Each is looked at once, unless older ones go.
    std::vector<std::size_t> looked(watched_.size());
    const auto take = [&] {
        for (std::size_t i = 0; i < watched_.size(); ++i) {
            if (watched_[i].kind != kind || watched_[i].node != node) {
                continue;
            }
            std::vector<Item>& items = items_of(watched_[i]);
            for (std::size_t k = items.size() == max_values ? 0 : looked[i]; k < items.size();
                 ++k) {
                if (is_wanted(items[k])) {
                    found = std::move(items[k]);
                    items.erase(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(k + 1));
                    return true;
                }
                ++count;
                last = text_of(items[k]);
            }
            looked[i] = items.size();
        }
        return false;
    };
    if (!run_until(take, limit - (world_.now() - begin))) {
        throw std::runtime_error{
            to_string(node) + (is_value ? " had no value that " : " had no Event that ") +
            std::string{wanted} + ", from " + text_of(begin.time_since_epoch()) + " to " +
            text_of(world_.now().time_since_epoch()) + "; " +
            (count == 0 ? "none came" : std::to_string(count) + " came, the last " + last) + "\n" +
            account_of_worlds()};
    }
    return found;
}

DataValue BenchClient::await_value(const NodeId& node,
                                   FunctionRef<bool(const DataValue&)> is_wanted,
                                   std::string_view wanted, Duration limit)
{
    return await_item<DataValue>(node, is_wanted, wanted, limit);
}

BenchEvent BenchClient::await_one(const NodeId& notifier,
                                  FunctionRef<bool(const BenchEvent&)> is_wanted,
                                  std::string_view wanted, Duration limit)
{
    return await_item<BenchEvent>(notifier, is_wanted, wanted, limit);
}

BenchEvent BenchClient::await_event(const NodeId& notifier, std::string_view message,
                                    Duration limit)
{
    return await_one(
        notifier, [&](const BenchEvent& event) { return event.message() == message; },
        "has the Message \"" + std::string{message} + "\"", limit);
}

} // namespace busbar::harness
