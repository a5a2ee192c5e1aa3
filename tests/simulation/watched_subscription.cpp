#include "watched_subscription.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include <busbar/types/filter.hpp>
#include <busbar/types/ids.hpp>

#include "server/event_fixture.hpp"

namespace busbar::test {

namespace {

/// InfoType DataValue and Overflow (Part 4, 7.38.1).
constexpr std::uint32_t overflow_info = 0x0480;
/// Watches that have gone and may still bring what is late.
constexpr std::size_t max_gone = 16;

std::int64_t to_number(std::string_view text)
{
    std::int64_t number = -1;
    std::from_chars(text.data(), text.data() + text.size(), number);
    return number;
}

/// False if the number must not come now.
bool receive(Watch& watch, std::int64_t number, const DeliveryJudge& judge)
{
    const auto last = watch.check.last();
    if (watch.check.receive(number)) {
        return true;
    }
    bool is_excused = last && number > *last;
    for (std::int64_t missed = last.value_or(0) + 1; is_excused && missed < number; ++missed) {
        is_excused = judge.may_miss(watch, missed);
    }
    return is_excused;
}

std::string describe(std::uint32_t handle, std::optional<std::int64_t> last, std::int64_t number)
{
    return "item " + std::to_string(handle) + ": " + std::to_string(number) + " after " +
           (last ? std::to_string(*last) : "nothing");
}

} // namespace

MonitoringParameters parameters_of(const Watch& watch, std::uint32_t client_handle)
{
    MonitoringParameters parameters;
    parameters.client_handle = client_handle;
    parameters.queue_size = watch.wanted_queue_size;
    parameters.discard_oldest = watch.kind == Plant::Kind::Event || client_handle % 2 == 0;
    if (watch.kind == Plant::Kind::Memory) {
        parameters.sampling_interval = client_handle % 4 == 0 ? 5'000 : 20'000;
    }
    if (watch.kind == Plant::Kind::Event) {
        parameters.filter = ExtensionObject::from(selecting({"EventType", "Message"}));
    }
    return parameters;
}

void WatchedSubscription::add_watch(Plant::Kind kind, std::size_t counter, std::uint32_t queue_size)
{
    Watch watch;
    watch.kind = kind;
    watch.counter = counter;
    watch.wanted_queue_size = queue_size;
    watches.emplace(++last_handle_, watch);
    std::size_t gone = 0;
    for (auto at = watches.end(); at != watches.begin();) {
        --at;
        if (at->second.state == Watch::State::Gone && ++gone > max_gone) {
            watches.erase(at);
            return;
        }
    }
}

void WatchedSubscription::allow_gaps()
{
    for (auto& [handle, watch] : watches) {
        watch.check.allow_gap();
    }
}

void WatchedSubscription::allow_repeats()
{
    for (auto& [handle, watch] : watches) {
        if (watch.kind != Plant::Kind::Event) {
            watch.check.allow_gap();
        }
    }
}

Duration WatchedSubscription::cycle() const
{
    const double longest = interval ? std::max(*interval, wanted_interval) : longest_interval;
    return std::chrono::duration_cast<Duration>(std::chrono::duration<double, std::milli>{longest});
}

void WatchedSubscription::heard(TimePoint now)
{
    last_heard = now;
    if (!std::exchange(is_caught_up, true)) {
        undisturbed_since = now;
    }
}

std::size_t WatchedSubscription::messages() const
{
    if (max_notifications == 0) {
        return 1;
    }
    std::size_t queued = 0;
    for (const auto& [handle, watch] : watches) {
        const bool is_there = watch.state == Watch::State::Live;
        // One more tells of events that were lost.
        queued +=
            is_there ? std::max(watch.queue_size.value_or(0), watch.wanted_queue_size) + 1 : 0;
    }
    return 1 + queued / max_notifications;
}

Watch* WatchedSubscription::find(std::uint32_t handle, DeliveryJudge& judge)
{
    const auto found = watches.find(handle);
    if (found != watches.end()) {
        return &found->second;
    }
    if (handle == 0 || handle > last_handle_) {
        judge.violation("a notification of an item that was never asked for");
    }
    return nullptr;
}

void WatchedSubscription::deliver_value(const MonitoredItemNotification& item, DeliveryJudge& judge)
{
    Watch* const watch = find(item.client_handle, judge);
    if (watch == nullptr) {
        return;
    }
    const std::uint32_t status = item.value.status.value();
    const std::int64_t number = item.value.value.value_or<std::int32_t>(-1);
    const auto last = watch->check.last();
    if ((status & overflow_info) == overflow_info) {
        watch->check.tell_overflow();
    } else if (status != 0) {
        judge.violation(describe(item.client_handle, last, number) + ", status " +
                        std::to_string(status));
    }
    if (number < 0 || !receive(*watch, number, judge)) {
        judge.violation(describe(item.client_handle, last, number));
    }
}

void WatchedSubscription::deliver_event(const EventFieldList& event, DeliveryJudge& judge)
{
    Watch* const watch = find(event.client_handle, judge);
    if (watch == nullptr || event.event_fields.size() != 2) {
        return;
    }
    if (event.event_fields[0].value_or<NodeId>({}).is(id::EventQueueOverflowEventType)) {
        watch->check.tell_overflow();
        watch->loss_told = judge.now();
        return;
    }
    const LocalizedText text = event.event_fields[1].value_or<LocalizedText>({});
    const std::int64_t number = to_number(text.text.view());
    const auto last = watch->check.last();
    if (number >= 0 && !receive(*watch, number, judge)) { // others are the server's own
        judge.violation("event " + describe(event.client_handle, last, number));
    }
}

void WatchedSubscription::deliver(const NotificationMessage& message, DeliveryJudge& judge)
{
    for (const ExtensionObject& part : message.notification_data) {
        if (const auto* changes = part.get_if<DataChangeNotification>()) {
            for (const MonitoredItemNotification& item : changes->monitored_items) {
                deliver_value(item, judge);
            }
        } else if (const auto* list = part.get_if<EventNotificationList>()) {
            for (const EventFieldList& event : list->events) {
                deliver_event(event, judge);
            }
        } else {
            judge.violation("a part of a message that nobody asked for");
        }
    }
}

} // namespace busbar::test
