#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "monitored_handles.hpp"
#include "sampling_group.hpp"

namespace busbar::server::detail {

/// The sampling of all data items of a server, in groups of equal intervals.
class Sampler {
public:
    /// `memory` pays for the data that all items of a variable share.
    Sampler(const SubscriptionNeeds& needs, TimerQueue& timers, MemoryAccount& memory);
    Sampler(const Sampler&) = delete;
    Sampler& operator=(const Sampler&) = delete;

    /// Samples the item at its new interval from now on; the first time when sample_new() is
    /// called. Without memory nothing changes.
    void add(ValueItem& item, TimePoint now);
    /// Takes the first samples of all items that were added meanwhile. The sources are notified
    /// before.
    void sample_new(TimePoint now);
    /// Reports to the sources what has changed in what is monitored.
    void tell_sources();
    /// Samples the new scans of the process images that are followed.
    void handle_scans(TimePoint now);
    /// True if a scan or the first sample of new items has failed, and no other event will trigger
    /// it again.
    [[nodiscard]] bool is_behind() const { return is_behind_; }
    void catch_up(TimePoint now);

    /// The shortest revised interval, zero if there are no intervals.
    [[nodiscard]] Duration smallest_revised_interval() const;
    /// The shortest interval between the last two samples of a group.
    [[nodiscard]] Duration smallest_actual_interval() const;

    /// Each item is looked up again with the next sample of its group.
    void look_up_again() { ++lookups_; }

    [[nodiscard]] SamplingIntervals& intervals() { return intervals_; }
    [[nodiscard]] const SamplingIntervals& intervals() const { return intervals_; }

    // Called by groups.

    [[nodiscard]] const SubscriptionNeeds& needs() const { return needs_; }
    [[nodiscard]] TimerQueue& timers() { return timers_; }
    [[nodiscard]] MemoryAccount& memory() { return memory_; }
    [[nodiscard]] MonitoredHandles& monitored() { return monitored_; }
    [[nodiscard]] bool is_overload(Duration revised, Duration actual) const;
    void remove(SamplingGroup& group);
    /// The removal of any role in the node's RolePermissions then counts as look_up_again().
    void watch_roles(model::NodeIndex node);
    /// When it changes, any item may have lost its right to be sampled.
    [[nodiscard]] std::uint64_t lookups() const { return lookups_; }

private:
    struct Followed {
        /// Its source may drop it before the server does.
        std::shared_ptr<ProcessImage> image;
        std::unique_ptr<SamplingGroup> group;
        /// The number of the last sampled scan.
        std::uint64_t last_scan;
        bool was_running;
    };

    /// Watches a node whose BrowseName is the name of a role.
    struct Role final : model::NodeWatch {
        explicit Role(Sampler& s) : sampler{s} {}
        void node_changed(model::NodeIndex node, bool is_removed) override;

        Sampler& sampler;
    };

    /// Returns whether the scans of any image may come as seldom.
    [[nodiscard]] bool may_follow(Duration interval) const;
    [[nodiscard]] SamplingGroup& group_of(const ValueItem& item);
    [[nodiscard]] SamplingGroup& follow(ProcessImage& image);
    static ImagePin take_scans(Followed& one, TimePoint now);
    static void take_scan(Followed& one, const ImagePin& pin, TimePoint now);
    void drop_unfollowed();

    const SubscriptionNeeds& needs_;
    TimerQueue& timers_;
    MemoryAccount& memory_;
    MonitoredHandles monitored_;
    SamplingIntervals intervals_;
    std::map<Duration, std::unique_ptr<SamplingGroup>> groups_;
    std::vector<Followed> followed_;
    /// Groups with items that have no sample yet.
    std::vector<SamplingGroup*> fresh_;
    std::unordered_map<model::NodeIndex, Role> roles_;
    std::uint64_t lookups_{0};
    bool is_behind_{false};
};

} // namespace busbar::server::detail
