#include "publishes.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <thread>
#include <vector>

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "process.hpp"

namespace busbar::bench {

namespace {

using namespace std::chrono_literals;

/// Publish requests that a session has waiting, which is what servers let it have.
constexpr std::size_t most_waiting = 10;

/// Of all threads: whether what they see counts, and whether they go on.
struct Measurement {
    std::atomic<bool> is_measuring{false};
    std::atomic<bool> is_over{false};
};

/// One session with its Subscriptions, and the thread that takes what they publish.
class Reader {
public:
    explicit Reader(const Measurement& phase) : phase_{&phase} {}

    [[nodiscard]] Result<void> open(Load& load) { return load.open(loop_, true); }
    [[nodiscard]] Result<void> subscribe(double interval_ms);
    void start()
    {
        thread_ = std::thread{[this] { outcome_ = run(); }};
    }
    /// Ends when the phase is over.
    [[nodiscard]] Result<void> join()
    {
        thread_.join();
        loop_.close();
        return outcome_;
    }

    std::size_t messages{0};
    std::size_t lost{0};

private:
    [[nodiscard]] Result<void> run();
    void take(const PublishResponse& response);
    [[nodiscard]] Result<void> publish(PublishRequest request);

    const Measurement* phase_;
    net::ClientLoop loop_;
    /// The last sequence number of each Subscription.
    std::map<std::uint32_t, std::uint32_t> sequences_;
    std::thread thread_;
    Result<void> outcome_;
};

Result<void> Reader::subscribe(double interval_ms)
{
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = interval_ms;
    request.requested_lifetime_count = 10'000;
    request.requested_max_keep_alive_count = 100;
    request.publishing_enabled = true;
    const auto event = loop_.call(request);
    const auto made = event ? event->response<CreateSubscriptionResponse>() : fail(event.error());
    if (!made) {
        return fail(made.error());
    }
    CreateMonitoredItemsRequest create;
    create.subscription_id = made->subscription_id;
    MonitoredItemCreateRequest& item = create.items_to_create.emplace_back();
    item.item_to_monitor.node_id = NodeId{0, id::Server_ServerStatus_CurrentTime};
    item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    item.monitoring_mode = MonitoringMode::Reporting;
    item.requested_parameters.sampling_interval = interval_ms;
    item.requested_parameters.queue_size = 1;
    const auto added = loop_.call(create);
    const auto items =
        added ? added->response<CreateMonitoredItemsResponse>() : fail(added.error());
    if (!items || items->results.empty()) {
        return fail(items ? StatusCode{status::Bad_UnknownResponse} : items.error());
    }
    sequences_[made->subscription_id] = 0;
    const StatusCode added_as = items->results[0].status_code;
    return added_as.is_bad() ? Result<void>{fail(added_as)} : Result<void>{};
}

Result<void> Reader::publish(PublishRequest request)
{
    const auto sent = loop_.client().send(std::move(request));
    return sent ? Result<void>{} : fail(sent.error());
}

Result<void> Reader::run()
{
    Result<void> done;
    for (std::size_t i = 0; done && i < std::min(most_waiting, 2 * sequences_.size()); ++i) {
        done = publish({});
    }
    while (done && !phase_->is_over) {
        const auto event = loop_.wait(100ms);
        if (!event) {
            continue;
        }
        if (event->kind != client::ConnectionEvent::Kind::Response) {
            return fail(event->status);
        }
        const auto response = event->response<PublishResponse>();
        if (!response) {
            return fail(response.error());
        }
        take(*response);
        PublishRequest next;
        next.subscription_acknowledgements.push_back(
            {response->subscription_id, response->notification_message.sequence_number});
        done = publish(std::move(next));
    }
    return done;
}

void Reader::take(const PublishResponse& response)
{
    const NotificationMessage& message = response.notification_message;
    if (message.notification_data.empty()) {
        return;
    }
    std::uint32_t& last = sequences_[response.subscription_id];
    lost += last != 0 && message.sequence_number != last + 1 ? 1U : 0U;
    last = message.sequence_number;
    messages += phase_->is_measuring ? 1U : 0U;
}

} // namespace

Result<Publishes> measure_publishes(Load& load, const Options& options,
                                    const PublishesOptions& publishes)
{
    Measurement phase;
    std::vector<std::unique_ptr<Reader>> readers;
    Result<void> done;
    for (std::size_t i = 0; done && i < publishes.sessions; ++i) {
        done = readers.emplace_back(std::make_unique<Reader>(phase))->open(load);
    }
    for (std::size_t i = 0; done && i < publishes.subscriptions; ++i) {
        done = readers[i % readers.size()]->subscribe(publishes.interval_ms);
    }
    if (!done) {
        return fail(done.error());
    }
    for (const auto& reader : readers) {
        reader->start();
    }
    std::this_thread::sleep_for(
        std::chrono::duration<double, std::milli>{10 * publishes.interval_ms});
    const TimePoint begin = clock_now();
    const double processor = processor_time(options.subscribe.server_pid);
    phase.is_measuring = true;
    std::this_thread::sleep_for(std::chrono::duration<double>{options.seconds});
    phase.is_measuring = false;
    Publishes measured;
    measured.seconds = elapsed_us(begin) / 1e6;
    measured.cpu_percent =
        (processor_time(options.subscribe.server_pid) - processor) / measured.seconds * 100;
    phase.is_over = true;
    for (const auto& reader : readers) {
        const Result<void> ended = reader->join();
        done = done ? ended : done;
        measured.messages += reader->messages;
        measured.lost += reader->lost;
    }
    return done ? Result<Publishes>{measured} : fail(done.error());
}

void print(const PublishesOptions& options, const Publishes& measured, bool json)
{
    const double per_second = static_cast<double>(measured.messages) / measured.seconds;
    const double wanted = static_cast<double>(options.subscriptions) / options.interval_ms * 1'000;
    std::printf(json ? "{\"subscriptions\": %zu, \"sessions\": %zu, \"interval_ms\": %g, "
                       "\"messages_per_second\": %.0f, \"wanted\": %.0f, \"cpu_percent\": %.1f, "
                       "\"lost\": %zu}\n"
                     : "%zu Subscriptions in %zu sessions at %g ms: %.0f messages a second of "
                       "%.0f, server %.1f %% of a core, %zu lost\n",
                options.subscriptions, options.sessions, options.interval_ms, per_second, wanted,
                measured.cpu_percent, measured.lost);
}

} // namespace busbar::bench
