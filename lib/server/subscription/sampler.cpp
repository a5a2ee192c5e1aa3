#include "sampler.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "sampling_context.hpp"
#include "subscription.hpp"

namespace busbar::server::detail {

ReadPlan plan_sample(const SubscriptionNeeds& needs, const Subscription& subscription,
                     const ReadTarget& id)
{
    const UserIdentity& user = subscription.user();
    const ReadingUser reader{user, subscription.is_encrypted()};
    const auto live_value = [&](const NodeId& node) {
        return needs.live_values.find(node, reader);
    };
    return plan_read({needs.space, needs.sources, subscription.rights(), live_value,
                      needs.wall_time(), needs.start_time, subscription.locales()},
                     id);
}

bool can_follow_scans(const SubscriptionNeeds& needs, const ReadPlan& plan)
{
    // Without a Waker nothing would report a scan.
    return needs.environment.waker != nullptr && plan.source != nullptr &&
           plan.source->process_image() != nullptr;
}

Sampler::Sampler(const SubscriptionNeeds& needs, TimerQueue& timers, MemoryAccount& memory)
    : needs_{needs}, timers_{timers}, memory_{memory},
      intervals_{!needs.limits.subscriptions.sampling.intervals.empty()}
{
}

SamplingGroup& Sampler::follow(ProcessImage& image)
{
    const auto found = std::find_if(followed_.begin(), followed_.end(),
                                    [&](const Followed& one) { return one.image.get() == &image; });
    if (found != followed_.end()) {
        return *found->group;
    }
    auto group = std::make_unique<SamplingGroup>(*this, Duration::zero());
    Followed& followed = followed_.emplace_back(
        Followed{image.shared_from_this(), std::move(group), 0, image.is_running()});
    image.follow_scans(true);
    if (const ImagePin latest = image.pin()) {
        followed.last_scan = latest.scan();
    }
    return *followed.group;
}

bool Sampler::may_follow(Duration interval) const
{
    if (interval == Duration::zero()) {
        return true;
    }
    if (!needs_.limits.subscriptions.sampling.samples_each_scan) {
        return false;
    }
    for (std::uint32_t i = 0; i < needs_.sources.size(); ++i) {
        const auto* const source = needs_.sources.find(i);
        const ProcessImage* const image = source != nullptr ? (*source)->process_image() : nullptr;
        if (image != nullptr && interval <= image->options().cycle) {
            return true;
        }
    }
    return false;
}

SamplingGroup& Sampler::group_of(const ValueItem& item)
{
    if (may_follow(item.interval())) {
        const ReadPlan plan = plan_sample(needs_, item.subscription(), item.target());
        if (can_follow_scans(needs_, plan) &&
            (item.interval() == Duration::zero() ||
             item.interval() <= plan.source->process_image()->options().cycle)) {
            return follow(*plan.source->process_image());
        }
    }
    // A variable that is no longer in an image is sampled as fast as possible.
    const Duration interval =
        std::max<Duration>(item.interval(), needs_.limits.subscriptions.sampling.min_interval);
    auto found = groups_.find(interval);
    if (found == groups_.end()) {
        found = groups_.emplace(interval, std::make_unique<SamplingGroup>(*this, interval)).first;
    }
    return *found->second;
}

void Sampler::add(ValueItem& item, TimePoint now)
{
    SamplingGroup& group = group_of(item);
    if (std::find(fresh_.begin(), fresh_.end(), &group) == fresh_.end()) {
        fresh_.push_back(&group); // first, as it may fail
    }
    group.add(item, now);
}

void Sampler::sample_new(TimePoint now)
{
    std::vector<SamplingGroup*> fresh = std::exchange(fresh_, {});
    busbar::detail::Undo undo{[&] {
        is_behind_ = true;
        fresh_ = std::move(fresh);
    }};
    std::unordered_map<const SamplingGroup*, ImagePin> latest;
    for (Followed& one : followed_) {
        // A new item's first value must not be followed by that of an older scan.
        if (std::find(fresh.begin(), fresh.end(), one.group.get()) != fresh.end()) {
            latest.emplace(one.group.get(), take_scans(one, now));
        }
    }
    for (SamplingGroup* group : fresh) {
        group->bind_new();
    }
    tell_sources();
    for (SamplingGroup* group : fresh) {
        const auto taken = latest.find(group);
        if (taken != latest.end()) {
            group->sample_new(taken->second, now);
        } else {
            group->sample_new(now);
        }
    }
    undo.keep();
}

void Sampler::tell_sources()
{
    monitored_.tell(needs_.sources);
}

void Sampler::catch_up(TimePoint now)
{
    is_behind_ = false;
    sample_new(now);
    handle_scans(now);
}

void Sampler::handle_scans(TimePoint now)
{
    busbar::detail::Undo undo{[&] { is_behind_ = true; }};
    for (Followed& one : followed_) {
        static_cast<void>(take_scans(one, now));
    }
    drop_unfollowed();
    undo.keep();
}

/// Returns the latest scan, which is the last that was taken.
ImagePin Sampler::take_scans(Followed& one, TimePoint now)
{
    // Before reading the queue: if a scan up to this one is missing in it then, it was lost because
    // the queue was full.
    ImagePin latest = one.image->pin();
    // At most as many as may wait: a faster task must not keep this loop busy.
    for (std::uint32_t i = 0; i < one.image->options().max_queued_scans; ++i) {
        const ImagePin pin = one.image->next_scan();
        if (!pin) {
            break;
        }
        take_scan(one, pin, now);
    }
    if (latest) {
        take_scan(one, latest, now);
    }
    const bool is_running = one.image->is_running();
    const bool has_changed = one.was_running != is_running;
    if ((has_changed && latest) || one.group->has_lost_source()) {
        one.group->sample_scan(latest, now, false); // for the status
    }
    one.was_running = is_running;
    return latest;
}

void Sampler::take_scan(Followed& one, const ImagePin& pin, TimePoint now)
{
    if (pin.scan() <= one.last_scan) { // it was sampled as the latest, before it was queued
        return;
    }
    const bool has_lost = one.last_scan != 0 && pin.scan() != one.last_scan + 1;
    one.group->sample_scan(pin, now, has_lost);
    one.last_scan = pin.scan(); // if sampling fails the scan is sampled again, or is lost
}

void Sampler::drop_unfollowed()
{
    std::erase_if(followed_, [this](const Followed& one) {
        if (one.group->empty()) {
            one.image->follow_scans(false);
            std::erase(fresh_, one.group.get());
        }
        return one.group->empty();
    });
}

bool Sampler::is_overload(Duration revised, Duration actual) const
{
    const auto percent = needs_.limits.subscriptions.sampling.overload_percent;
    return percent && static_cast<double>(actual.count()) >
                          static_cast<double>(revised.count()) * (1 + *percent / 100);
}

void Sampler::remove(SamplingGroup& group)
{
    std::erase(fresh_, &group);
    groups_.erase(group.interval());
}

void Sampler::watch_roles(model::NodeIndex node)
{
    const model::AddressSpace& space = needs_.space;
    const Array<RolePermissionType>* const permissions = space.role_permissions(node);
    if (permissions == nullptr) {
        return;
    }
    for (const RolePermissionType& permission : *permissions) {
        const model::NodeIndex role = space.find(permission.role_id);
        if (role != model::no_node && roles_.find(role) == roles_.end()) {
            space.journal().watch(role, model::NodeAspect::Existence,
                                  roles_.try_emplace(role, *this).first->second);
        }
    }
}

void Sampler::Role::node_changed(model::NodeIndex node, bool /*is_removed*/)
{
    sampler.look_up_again();
    sampler.roles_.erase(node); // and this with it
}

Duration Sampler::smallest_revised_interval() const
{
    const auto found = std::find_if(groups_.begin(), groups_.end(),
                                    [](const auto& entry) { return !entry.second->empty(); });
    return found == groups_.end() ? Duration::zero() : found->first;
}

Duration Sampler::smallest_actual_interval() const
{
    Duration smallest{0};
    for (const auto& [interval, group] : groups_) {
        const Duration actual = group->actual_interval();
        if (actual != Duration::zero() && (smallest == Duration::zero() || actual < smallest)) {
            smallest = actual;
        }
    }
    return smallest;
}

void remove_from_group(ValueItem& item)
{
    SamplingGroup::of(item)->remove(item);
}

void rebind_in_group(ValueItem& item)
{
    SamplingGroup::of(item)->rebind(item);
}

void node_changed_in_group(ValueItem& item)
{
    SamplingGroup::of(item)->node_changed(item);
}

} // namespace busbar::server::detail
