#include "subscribe.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

#include <busbar/client/response_limits.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "load.hpp"
#include "process.hpp"

namespace busbar::bench {

namespace {

constexpr std::size_t items_at_once = 5'000;
constexpr std::size_t publishes_under_way = 4;

NodeId numbered(std::string text, std::size_t number)
{
    const std::size_t at = text.find("{}");
    if (at != std::string::npos) {
        text.replace(at, 2, std::to_string(number));
    }
    return NodeId::parse(text).value_or(NodeId{});
}

/// One subscription with its items, and the account of what came.
class Subscriber {
public:
    Subscriber(net::ClientLoop& loop, const SubscribeOptions& options, std::size_t items)
        : loop_{&loop}, options_{&options}, last_(items / 2)
    {
        row_.items = items;
        row_.smallest_step = std::numeric_limits<std::uint16_t>::max();
    }

    [[nodiscard]] Result<SubscribeRow> run();

private:
    template <typename Response, typename Request>
    [[nodiscard]] Result<void> call(Request& request, Response& response);
    [[nodiscard]] Result<void> create();
    [[nodiscard]] Result<void> add_items(std::size_t first, std::size_t count);
    [[nodiscard]] Result<void> publish();
    [[nodiscard]] Result<void> take(const PublishResponse& response);
    void take(const MonitoredItemNotification& notification);
    [[nodiscard]] Result<void> measure();
    [[nodiscard]] Result<void> remove();

    struct Last {
        bool is_known{false};
        std::uint16_t value{0};
        StatusCode status;
    };

    net::ClientLoop* loop_;
    const SubscribeOptions* options_;
    std::vector<Last> last_; // of the moving items, by client handle
    SubscribeRow row_;
    std::uint32_t subscription_id_{0};
    std::uint32_t sequence_{0};
    std::size_t notifications_{0};
    bool is_measuring_{false};
    TimePoint last_publish_;
    Array<SubscriptionAcknowledgement> acknowledgements_;
    // The event that responses borrow their texts from.
    client::ConnectionEvent event_;
};

template <typename Response, typename Request>
Result<void> Subscriber::call(Request& request, Response& response)
{
    auto event = loop_->call(request);
    if (!event) {
        return fail(event.error());
    }
    event_ = *std::move(event);
    auto decoded = event_.response<Response>(generous_limits());
    if (!decoded) {
        return fail(decoded.error());
    }
    response = *std::move(decoded);
    return {};
}

Result<void> Subscriber::create()
{
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = options_->publishing_ms;
    request.requested_lifetime_count = 600;
    request.requested_max_keep_alive_count = 10;
    request.publishing_enabled = true;
    CreateSubscriptionResponse response;
    if (const auto created = call(request, response); !created) {
        return created;
    }
    subscription_id_ = response.subscription_id;
    for (std::size_t first = 0; first < row_.items; first += items_at_once) {
        const auto added = add_items(first, std::min(items_at_once, row_.items - first));
        if (!added) {
            return added;
        }
    }
    return {};
}

Result<void> Subscriber::add_items(std::size_t first, std::size_t count)
{
    CreateMonitoredItemsRequest request;
    request.subscription_id = subscription_id_;
    request.timestamps_to_return = TimestampsToReturn::Source;
    for (std::size_t i = first; i < first + count; ++i) {
        const bool is_moving = i < last_.size();
        MonitoredItemCreateRequest& item = request.items_to_create.emplace_back();
        item.item_to_monitor.node_id =
            is_moving ? numbered(options_->moving, i) : numbered(options_->still, i - last_.size());
        item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.client_handle = static_cast<std::uint32_t>(i);
        item.requested_parameters.sampling_interval = options_->sampling_ms;
        item.requested_parameters.queue_size = options_->queue_size;
        item.requested_parameters.discard_oldest = true;
    }
    CreateMonitoredItemsResponse response;
    if (const auto created = call(request, response); !created) {
        return created;
    }
    for (const MonitoredItemCreateResult& result : response.results) {
        if (result.status_code.is_bad()) {
            return fail(result.status_code);
        }
    }
    return {};
}

Result<void> Subscriber::publish()
{
    PublishRequest request;
    request.subscription_acknowledgements = std::exchange(acknowledgements_, {});
    const auto sent = loop_->client().send(request);
    return sent ? Result<void>{} : fail(sent.error());
}

void Subscriber::take(const MonitoredItemNotification& notification)
{
    ++notifications_;
    if (notification.client_handle >= last_.size()) {
        return; // one of those that stand still
    }
    const auto* value = notification.value.value.get_if<std::int16_t>();
    if (value == nullptr) {
        ++row_.values_wrong;
        return;
    }
    Last& last = last_[notification.client_handle];
    const auto now = static_cast<std::uint16_t>(*value);
    const auto step = static_cast<std::uint16_t>(now - last.value);
    // What only has another status, as with an overload, is the same value again.
    const bool is_again = step == 0 && notification.value.status != last.status;
    if (last.is_known && !is_again && (step == 0 || step > 0x7FFF)) {
        ++row_.values_wrong;
    } else if (last.is_known && !is_again) {
        row_.smallest_step = std::min(row_.smallest_step, step);
        row_.largest_step = std::max(row_.largest_step, step);
    }
    last = {true, now, notification.value.status};
}

Result<void> Subscriber::take(const PublishResponse& response)
{
    const NotificationMessage& message = response.notification_message;
    const bool is_keep_alive = message.notification_data.empty();
    if (!is_keep_alive) {
        if (sequence_ != 0 && message.sequence_number != sequence_ + 1) {
            ++row_.messages_lost;
        }
        sequence_ = message.sequence_number;
        acknowledgements_.push_back({subscription_id_, message.sequence_number});
    }
    for (const ExtensionObject& data : message.notification_data) {
        const auto* change = data.get_if<DataChangeNotification>();
        if (change == nullptr) {
            return fail(status::Bad_UnknownResponse);
        }
        for (const MonitoredItemNotification& notification : change->monitored_items) {
            take(notification);
        }
    }
    // Several messages of one cycle count as one publish.
    if (!response.more_notifications && !is_keep_alive && is_measuring_) {
        const double interval = elapsed_us(last_publish_) / 1e3;
        ++row_.publishes;
        row_.mean_interval_ms += interval;
        row_.worst_interval_ms = std::max(row_.worst_interval_ms, interval);
    }
    if (!response.more_notifications) {
        last_publish_ = clock_now();
    }
    return {};
}

Result<void> Subscriber::measure()
{
    const double warm_up_s = options_->warm_up_seconds;
    TimePoint begin = clock_now();
    double processor = 0;
    while (elapsed_us(begin) < (is_measuring_ ? options_->seconds : warm_up_s) * 1e6) {
        auto event = loop_->wait();
        if (!event || event->kind != client::ConnectionEvent::Kind::Response) {
            return fail(event ? event->status : status::Bad_Timeout);
        }
        event_ = *std::move(event);
        const auto response = event_.response<PublishResponse>(generous_limits());
        const auto taken = response ? take(*response) : fail(response.error());
        const auto sent = taken ? publish() : taken;
        if (!sent) {
            return sent;
        }
        if (!is_measuring_ && elapsed_us(begin) >= warm_up_s * 1e6) {
            is_measuring_ = true;
            begin = clock_now();
            last_publish_ = begin;
            notifications_ = 0;
            processor = processor_time(options_->server_pid);
        }
    }
    const double seconds = elapsed_us(begin) / 1e6;
    row_.notifications_per_second = static_cast<double>(notifications_) / seconds;
    row_.mean_interval_ms /= static_cast<double>(std::max<std::size_t>(row_.publishes, 1));
    row_.cpu_percent = (processor_time(options_->server_pid) - processor) / seconds * 100;
    row_.resident_mb = memory_of(options_->server_pid).now_mb;
    return {};
}

Result<void> Subscriber::remove()
{
    DeleteSubscriptionsRequest request;
    request.subscription_ids.push_back(subscription_id_);
    DeleteSubscriptionsResponse response;
    return call(request, response);
}

Result<SubscribeRow> Subscriber::run()
{
    Result<void> done = create();
    for (std::size_t i = 0; done && i < publishes_under_way; ++i) {
        done = publish();
    }
    if (done) {
        done = measure();
    }
    if (done) {
        done = remove();
    }
    if (!done) {
        return fail(done.error());
    }
    return row_;
}

} // namespace

Result<SubscribeRow> subscribe(net::ClientLoop& loop, const SubscribeOptions& options,
                               std::size_t items)
{
    return Subscriber{loop, options, items}.run();
}

} // namespace busbar::bench
