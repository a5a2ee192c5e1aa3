#include "watched_subscription.hpp"

#include <algorithm>

namespace busbar::client::detail {

namespace {

constexpr std::uint32_t most_doublings = 5; // 32 s

} // namespace

bool ItemWork::is_creation_done() const
{
    return std::all_of(to_create.begin(), to_create.end(),
                       [](const auto& queue) { return queue.empty(); });
}

void ItemWork::clear()
{
    *this = ItemWork{};
}

bool Refresh::is_reading() const
{
    return std::any_of(to_read.begin(), to_read.end(),
                       [](const auto& queue) { return !queue.empty(); });
}

/// Pending requests will not be answered; they are repeated.
void Refresh::interrupt()
{
    is_due = is_due || is_under_way || is_reading();
    is_under_way = false;
    read.cancel();
    for (auto& queue : to_read) {
        queue.clear();
    }
}

WatchedSubscription::WatchedSubscription(SubscriptionHandle name, SubscriptionSettings wished,
                                         SubscriptionHandlers told, std::size_t max_missing)
    : handle{name}, settings{wished},
      handlers{std::make_shared<const SubscriptionHandlers>(std::move(told))}, messages{max_missing}
{
}

DeliveryMode WatchedSubscription::mode() const
{
    switch (phase) {
    case Phase::Live:
        return DeliveryMode::Publishing;
    case Phase::Polling:
        return DeliveryMode::Polling;
    case Phase::Wished:
    case Phase::Creating:
    case Phase::Transferring:
        break;
    }
    return DeliveryMode::None;
}

TimePoint WatchedSubscription::next_deadline(TimePoint handled_until) const
{
    TimePoint next = no_deadline;
    if (phase == Phase::Live) {
        next = messages.silent_at;
    }
    if (!is_busy && retry_at > handled_until) {
        next = std::min(next, retry_at);
    }
    if (!messages.is_republishing && messages.republish_at > handled_until) {
        next = std::min(next, messages.republish_at);
    }
    if (refresh.at > handled_until && (refresh.is_due || refresh.is_reading())) {
        next = std::min(next, refresh.at);
    }
    for (const auto& [key, group] : polls) {
        next = group.is_reading ? next : std::min(next, group.due);
    }
    return next;
}

void WatchedSubscription::try_later(TimePoint now)
{
    const auto doublings = std::min(failures++, most_doublings);
    retry_at = now + first_retry * (1U << doublings);
}

void WatchedSubscription::lose(StatusCode reason)
{
    ++refresh.losses;
    refresh.is_due = true;
    messages.lose(reason);
}

void WatchedSubscription::begin_anew()
{
    ++incarnation;
    phase = Phase::Wished;
    is_busy = false;
    is_uncertain = false;
    refresh.interrupt();
    under_way.clear();
    redo = {};
    messages.restart();
    // However often a server removes it, it is created at most once a second.
    retry_at = created_at + first_retry;
}

void WatchedSubscription::interrupt(ItemTable& table)
{
    messages.interrupt();
    refresh.interrupt();
    if (phase == Phase::Creating) {
        phase = Phase::Wished;
    }
    for (auto& [key, group] : polls) {
        group.is_reading = false;
    }
    is_busy = false;
    for (const ItemHandle item : std::exchange(under_way, {})) {
        queue_creation(table, item);
    }
    if (redo) {
        std::exchange(redo, {})(*this);
    }
}

void WatchedSubscription::queue_all_items(ItemTable& table)
{
    work.clear();
    for (const ItemHandle item : items) {
        if (Item* found = table.find(item)) {
            found->is_created = false;
            found->server_id = 0;
            queue_creation(table, item);
        }
    }
    for (auto& [trigger, link] : links) {
        link.made.clear();
        link.stray.clear();
        work.to_link.push_back(trigger);
    }
}

void WatchedSubscription::queue_creation(ItemTable& table, ItemHandle item)
{
    if (const Item* found = table.find(item)) {
        work.to_create[static_cast<std::size_t>(found->parameters->timestamps)].push_back(item);
    }
}

void WatchedSubscription::report_gap(DateTime until)
{
    if (!messages.loss) {
        return;
    }
    const Gap gap{handle, messages.loss->from, until, messages.loss->reason};
    messages.loss.reset();
    const auto told = handlers;
    if (told->on_gap) {
        told->on_gap(gap);
    }
}

void WatchedSubscription::report_status(StatusCode status,
                                        const CreateSubscriptionResponse& response)
{
    const auto told = handlers;
    if (told->on_status) {
        told->on_status(status, mode(), response);
    }
}

void WatchedSubscription::report_items(ItemTable& table, const ItemStatuses& statuses) const
{
    const auto told = handlers;
    if (!told->on_item) {
        return;
    }
    for (const auto& [item, status] : statuses) {
        if (table.find(item) != nullptr) {
            told->on_item(item, status);
        }
    }
}

} // namespace busbar::client::detail
