#include "monitored_item.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "subscription.hpp"

namespace busbar::server::detail {

namespace {

/// Both sides' pointers, in vectors that double.
constexpr std::size_t link_cost = 4 * sizeof(void*);

} // namespace

MonitoredItem::MonitoredItem(Subscription& subscription, Kind kind, std::uint32_t client_handle,
                             MonitoringMode mode)
    : subscription_{&subscription}, client_handle_{client_handle}, mode_{mode}, kind_{kind}
{
    subscription.count_disabled(mode == MonitoringMode::Disabled ? 1 : 0);
}

MonitoredItem::~MonitoredItem()
{
    while (!links_.empty()) {
        forget_link(*links_.back());
    }
    while (!triggers_.empty()) {
        triggers_.back()->forget_link(*this);
    }
    subscription_->ready(kind_).remove(*this);
    subscription_->count_disabled(mode_ == MonitoringMode::Disabled ? -1 : 0);
}

std::size_t MonitoredItem::reportable() const
{
    return mode_ == MonitoringMode::Reporting ? queued() : std::min(released_, queued());
}

void MonitoredItem::notify()
{
    if (mode_ == MonitoringMode::Reporting) {
        subscription_->ready(kind_).add(*this);
    }
    for (MonitoredItem* triggered : links_) {
        triggered->release_queue();
    }
}

void MonitoredItem::release_queue()
{
    // An item that reports by itself needs no trigger, and one that is disabled has no queue.
    if (mode_ == MonitoringMode::Sampling && queued() != 0) {
        released_ = queued();
        subscription_->ready(kind_).add(*this);
    }
}

void MonitoredItem::set_mode(const ItemContext& context, MonitoringMode mode)
{
    const MonitoringMode before = std::exchange(mode_, mode);
    released_ = 0;
    if (mode == MonitoringMode::Disabled) {
        clear();
    }
    if (reportable() != 0) {
        subscription_->ready(kind_).add(*this);
    } else {
        subscription_->ready(kind_).remove(*this);
    }
    if (mode != before) {
        subscription_->count_disabled((mode == MonitoringMode::Disabled ? 1 : 0) -
                                      (before == MonitoringMode::Disabled ? 1 : 0));
        mode_changed(context, before);
    }
}

StatusCode MonitoredItem::add_link(MonitoredItem& triggered, std::size_t max_links)
{
    if (std::find(links_.begin(), links_.end(), &triggered) != links_.end()) {
        return status::Good;
    }
    if (links_.size() >= max_links || triggered.triggers_.size() >= max_links) {
        return status::Bad_TooManyOperations;
    }
    if (!subscription_->memory().charge(link_cost)) {
        return status::Bad_OutOfMemory;
    }
    busbar::detail::Undo undo{[&] { forget_link(triggered); }};
    links_.push_back(&triggered);
    triggered.triggers_.push_back(this);
    undo.keep();
    return status::Good;
}

bool MonitoredItem::remove_link(MonitoredItem& triggered)
{
    if (std::find(links_.begin(), links_.end(), &triggered) == links_.end()) {
        return false;
    }
    forget_link(triggered);
    return true;
}

void MonitoredItem::forget_link(MonitoredItem& triggered)
{
    std::erase(triggered.triggers_, this);
    std::erase(links_, &triggered);
    subscription_->memory().release(link_cost);
}

} // namespace busbar::server::detail
