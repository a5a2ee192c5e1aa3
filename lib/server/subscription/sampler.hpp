#pragma once

#include <map>
#include <memory>
#include <vector>

#include "sampling_group.hpp"

namespace busbar::server::detail {

/// The sampling of all data items of a server, in groups of equal intervals.
class Sampler {
public:
    Sampler(Core& core, TimerQueue& timers) : core_{core}, timers_{timers} {}
    Sampler(const Sampler&) = delete;
    Sampler& operator=(const Sampler&) = delete;

    /// Samples the item from now on; the first time when sample_new() is called.
    void add(DataItem& item, TimePoint now);
    /// First samples of the items that were added meanwhile, together.
    void sample_new(TimePoint now);
    /// Samples the scans that have come in the process images which are followed.
    void handle_scans(TimePoint now);

    /// The shortest revised interval, zero if nothing is sampled in intervals.
    [[nodiscard]] Duration smallest_revised_interval() const;
    /// The shortest interval between the last two samples of a group.
    [[nodiscard]] Duration smallest_actual_interval() const;

    // For groups.

    [[nodiscard]] Core& core() { return core_; }
    [[nodiscard]] TimerQueue& timers() { return timers_; }
    [[nodiscard]] bool is_overload(Duration revised, Duration actual) const;
    void remove(SamplingGroup& group);

private:
    struct Followed {
        ProcessImage* image;
        std::unique_ptr<SamplingGroup> group;
    };

    [[nodiscard]] SamplingGroup& group_of(const DataItem& item);
    [[nodiscard]] SamplingGroup& follow(ProcessImage& image);
    void take_scans(const Followed& followed, TimePoint now);
    void drop_unfollowed();

    Core& core_;
    TimerQueue& timers_;
    std::map<Duration, std::unique_ptr<SamplingGroup>> groups_;
    std::vector<Followed> followed_;
    /// With items that have no sample yet.
    std::vector<SamplingGroup*> fresh_;
};

} // namespace busbar::server::detail
