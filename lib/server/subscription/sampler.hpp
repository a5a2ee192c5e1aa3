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
    /// `memory` pays for what all items of a variable share.
    Sampler(const SubscriptionNeeds& needs, TimerQueue& timers, MemoryAccount& memory);
    Sampler(const Sampler&) = delete;
    Sampler& operator=(const Sampler&) = delete;

    /// Samples the item at its interval from now on, and not as before; the first time when
    /// sample_new() is called. Where there is no memory all is as before.
    void add(ValueItem& item, TimePoint now);
    /// First samples of the items that were added meanwhile, together. The sources are told before.
    void sample_new(TimePoint now);
    /// Tells the sources what is monitored otherwise than before.
    void tell_sources();
    /// Samples the scans that have come in the process images which are followed.
    void handle_scans(TimePoint now);
    /// A scan or the first sample of new items has failed, and nothing else may come that has it
    /// taken again.
    [[nodiscard]] bool is_behind() const { return is_behind_; }
    void catch_up(TimePoint now);

    /// The shortest revised interval, zero if nothing is sampled in intervals.
    [[nodiscard]] Duration smallest_revised_interval() const;
    /// The shortest interval between the last two samples of a group.
    [[nodiscard]] Duration smallest_actual_interval() const;

    /// With the next sample of its group each item is looked up anew.
    void look_up_again() { ++lookups_; }

    [[nodiscard]] SamplingIntervals& intervals() { return intervals_; }
    [[nodiscard]] const SamplingIntervals& intervals() const { return intervals_; }

    // For groups.

    [[nodiscard]] const SubscriptionNeeds& needs() const { return needs_; }
    [[nodiscard]] TimerQueue& timers() { return timers_; }
    [[nodiscard]] MemoryAccount& memory() { return memory_; }
    [[nodiscard]] MonitoredHandles& monitored() { return monitored_; }
    [[nodiscard]] bool is_overload(Duration revised, Duration actual) const;
    void remove(SamplingGroup& group);
    /// Has the removal of any role that the node's RolePermissions name count as look_up_again().
    void watch_roles(model::NodeIndex node);
    /// When it changes, any item may have lost what let it be sampled.
    [[nodiscard]] std::uint64_t lookups() const { return lookups_; }

private:
    struct Followed {
        /// Its source may let it go before the server does.
        std::shared_ptr<ProcessImage> image;
        std::unique_ptr<SamplingGroup> group;
        /// The number of the last one that was sampled.
        std::uint64_t last_scan;
        bool was_running;
    };

    /// Watches the node whose BrowseName is a role's.
    struct Role final : model::NodeWatch {
        explicit Role(Sampler& s) : sampler{s} {}
        void node_changed(model::NodeIndex node, bool is_removed) override;

        Sampler& sampler;
    };

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
    /// With items that have no sample yet.
    std::vector<SamplingGroup*> fresh_;
    std::unordered_map<model::NodeIndex, Role> roles_;
    std::uint64_t lookups_{0};
    bool is_behind_{false};
};

} // namespace busbar::server::detail
