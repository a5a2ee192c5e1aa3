#include "monitored_item.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "subscription.hpp"

namespace busbar::server::detail {

namespace {

/// Both sides' pointers, in vectors that double, and the memory of each side's first one.
constexpr std::size_t link_cost = 4 * sizeof(void*) + 4 * sizeof(std::vector<void*>);

} // namespace

MonitoredItem::MonitoredItem(Subscription& subscription, Kind kind, std::uint32_t client_handle,
                             MonitoringMode mode)
    : subscription_{&subscription},
      client_handle_{client_handle}, mode_{static_cast<std::uint8_t>(mode)}, kind_{kind}
{
    subscription.count_disabled(mode == MonitoringMode::Disabled ? 1 : 0);
}

MonitoredItem::~MonitoredItem()
{
    while (links_ != nullptr && !links_->triggered.empty()) {
        forget_link(*links_->triggered.back());
    }
    while (links_ != nullptr && !links_->triggers.empty()) {
        links_->triggers.back()->forget_link(*this);
    }
    subscription_->ready(kind_).remove(*this);
    subscription_->count_disabled(mode() == MonitoringMode::Disabled ? -1 : 0);
}

std::size_t MonitoredItem::reportable() const
{
    return mode() == MonitoringMode::Reporting ? queued()
                                               : std::min<std::size_t>(released_, queued());
}

void MonitoredItem::notify()
{
    if (mode() == MonitoringMode::Reporting) {
        subscription_->ready(kind_).add(*this);
    }
    if (links_ != nullptr) {
        for (MonitoredItem* triggered : links_->triggered) {
            triggered->release_queue();
        }
    }
}

void MonitoredItem::release_queue()
{
    // A reporting item needs no trigger, and a disabled one has no queue.
    if (mode() == MonitoringMode::Sampling && queued() != 0) {
        released_ = static_cast<std::uint32_t>(queued());
        subscription_->ready(kind_).add(*this);
    }
}

void MonitoredItem::set_mode(const ItemContext& context, MonitoringMode mode)
{
    const MonitoringMode before = this->mode();
    keep_mode(mode);
    if (mode != before) {
        busbar::detail::Undo undo{[&] { keep_mode(before); }};
        mode_changed(context, before);
        undo.keep();
        subscription_->count_disabled((mode == MonitoringMode::Disabled ? 1 : 0) -
                                      (before == MonitoringMode::Disabled ? 1 : 0));
    }
    released_ = 0;
    if (mode == MonitoringMode::Disabled) {
        clear();
    }
    if (reportable() != 0) {
        subscription_->ready(kind_).add(*this);
    } else {
        subscription_->ready(kind_).remove(*this);
    }
}

bool MonitoredItem::triggers(const MonitoredItem& triggered) const
{
    return links_ != nullptr && std::find(links_->triggered.begin(), links_->triggered.end(),
                                          &triggered) != links_->triggered.end();
}

StatusCode MonitoredItem::add_link(MonitoredItem& triggered, std::size_t max_links)
{
    if (triggers(triggered)) {
        return status::Good;
    }
    const auto is_full = [&](const MonitoredItem& item, std::vector<MonitoredItem*> Links::*side) {
        return (item.links_ != nullptr ? (*item.links_.*side).size() : 0) >= max_links;
    };
    if (is_full(*this, &Links::triggered) || is_full(triggered, &Links::triggers)) {
        return status::Bad_TooManyOperations;
    }
    if (!subscription_->memory().charge(link_cost)) {
        return status::Bad_OutOfMemory;
    }
    busbar::detail::Undo undo{[&] { forget_link(triggered); }};
    for (MonitoredItem* const item : {this, &triggered}) {
        if (item->links_ == nullptr) {
            item->links_ = std::make_unique<Links>();
        }
    }
    links_->triggered.push_back(&triggered);
    triggered.links_->triggers.push_back(this);
    undo.keep();
    return status::Good;
}

bool MonitoredItem::remove_link(MonitoredItem& triggered)
{
    if (!triggers(triggered)) {
        return false;
    }
    forget_link(triggered);
    return true;
}

void MonitoredItem::forget_link(MonitoredItem& triggered)
{
    if (triggered.links_ != nullptr) {
        std::erase(triggered.links_->triggers, this);
    }
    if (links_ != nullptr) {
        std::erase(links_->triggered, &triggered);
    }
    subscription_->memory().release(link_cost);
}

} // namespace busbar::server::detail
