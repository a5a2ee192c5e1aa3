#include "sampler.hpp"

#include <algorithm>
#include <utility>

#include "sampling_context.hpp"
#include "server/core.hpp"
#include "server/server_object.hpp"
#include "subscription.hpp"

namespace busbar::server::detail {

ReadPlan plan_sample(Core& core, const UserIdentity& user, const ReadValueId& id)
{
    const auto live_value = [&](const NodeId& node) { return server_value(core, node, user); };
    return plan_read({core.address_space,
                      core.sources,
                      {user, core.environment.access},
                      live_value,
                      core.environment.wall_clock->now()},
                     id);
}

bool can_follow_scans(const Core& core, const ReadPlan& plan)
{
    // Without a Waker nobody would tell of a scan.
    return core.environment.waker != nullptr && plan.source != nullptr &&
           plan.source->source().process_image() != nullptr;
}

SamplingGroup& Sampler::follow(ProcessImage& image)
{
    const auto found = std::find_if(followed_.begin(), followed_.end(),
                                    [&](const Followed& one) { return one.image == &image; });
    if (found != followed_.end()) {
        return *found->group;
    }
    image.follow_scans(true);
    followed_.push_back({&image, std::make_unique<SamplingGroup>(*this, Duration::zero())});
    return *followed_.back().group;
}

SamplingGroup& Sampler::group_of(const DataItem& item)
{
    if (item.interval() == Duration::zero()) {
        const ReadPlan plan = plan_sample(core_, item.subscription().user(), item.value_id());
        if (can_follow_scans(core_, plan)) {
            return follow(*plan.source->source().process_image());
        }
    }
    // What used to lie in an image, and does not any more, is sampled as fast as can be.
    const Duration interval =
        std::max<Duration>(item.interval(), core_.limits().subscriptions.sampling.min_interval);
    auto& group = groups_[interval];
    if (group == nullptr) {
        group = std::make_unique<SamplingGroup>(*this, interval);
    }
    return *group;
}

void Sampler::add(DataItem& item, TimePoint now)
{
    SamplingGroup& group = group_of(item);
    group.add(item, now);
    if (std::find(fresh_.begin(), fresh_.end(), &group) == fresh_.end()) {
        fresh_.push_back(&group);
    }
}

void Sampler::sample_new(TimePoint now)
{
    for (SamplingGroup* group : std::exchange(fresh_, {})) {
        const auto followed =
            std::find_if(followed_.begin(), followed_.end(),
                         [&](const Followed& one) { return one.group.get() == group; });
        if (followed == followed_.end()) {
            group->sample_new(now);
            continue;
        }
        // Scans that wait must not come after a later one. What is pinned before they are taken is
        // not later than those that follow.
        const ImagePin pin = followed->image->pin();
        take_scans(*followed, now);
        group->sample_new(pin, now);
    }
}

/// At most as many as may wait: a task that is faster than this must not keep the server here.
void Sampler::take_scans(const Followed& followed, TimePoint now)
{
    for (std::uint32_t i = 0; i < followed.image->options().max_queued_scans; ++i) {
        const ImagePin pin = followed.image->next_scan();
        if (!pin) {
            break;
        }
        followed.group->sample_scan(pin, now);
    }
}

void Sampler::handle_scans(TimePoint now)
{
    for (const Followed& one : followed_) {
        take_scans(one, now);
    }
    drop_unfollowed();
}

void Sampler::drop_unfollowed()
{
    std::erase_if(followed_, [](const Followed& one) {
        if (one.group->empty()) {
            one.image->follow_scans(false);
        }
        return one.group->empty();
    });
}

bool Sampler::is_overload(Duration revised, Duration actual) const
{
    const auto percent = core_.config.limits.subscriptions.sampling.overload_percent;
    return percent && static_cast<double>(actual.count()) >
                          static_cast<double>(revised.count()) * (1 + *percent / 100);
}

void Sampler::remove(SamplingGroup& group)
{
    std::erase(fresh_, &group);
    groups_.erase(group.interval());
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

void remove_from_group(DataItem& item)
{
    SamplingGroup::of(item)->remove(item);
}

void rebind_in_group(DataItem& item)
{
    SamplingGroup::of(item)->rebind(item);
}

} // namespace busbar::server::detail
