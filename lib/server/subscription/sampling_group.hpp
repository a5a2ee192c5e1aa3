#pragma once

#include <memory>
#include <vector>

#include "server/data/data_call.hpp"
#include "timer_queue.hpp"
#include "value_item.hpp"
#include "watched_images.hpp"

namespace busbar::server::detail {

class Sampler;

/// The data items with one sampling interval: each time the values of one source are requested in
/// one batch, those of a process image are compared in place, and all others are read from the
/// address space.
class SamplingGroup final : public Timer {
public:
    /// `interval` is zero for the items that follow the scans of one image.
    SamplingGroup(Sampler& sampler, Duration interval);
    SamplingGroup(const SamplingGroup&) = delete;
    SamplingGroup& operator=(const SamplingGroup&) = delete;
    ~SamplingGroup() override;

    [[nodiscard]] Duration interval() const { return interval_; }
    /// The time between the last two samples; zero before the second.
    [[nodiscard]] Duration actual_interval() const { return actual_interval_; }
    [[nodiscard]] bool empty() const { return item_count_ == 0; }
    /// True if the source of a watched image is destroyed. The next sample detects that for its
    /// items, and drops the image.
    [[nodiscard]] bool has_lost_source() const { return images_.has_lost_source(); }
    /// Returns the group that the item is in; null if there is none.
    [[nodiscard]] static SamplingGroup* of(const ValueItem& item) { return item.group_; }

    /// Moves the item here from its group. Without memory it stays there.
    void add(ValueItem& item, TimePoint now);
    void remove(ValueItem& item);
    /// Looks up the item's source again.
    void rebind(ValueItem& item);
    /// Does the same, called from the item's NodeWatch.
    void node_changed(ValueItem& item);
    /// Finds the sources of the items that were added since the last sample.
    void bind_new();
    /// Samples these items; after bind_new().
    void sample_new(TimePoint now);
    /// Samples likewise, the items of an image from the pinned scan.
    void sample_new(const ImagePin& pin, TimePoint now);
    void expire(TimePoint now) override;
    /// Sampling precedes publishing.
    [[nodiscard]] unsigned rank() const override { return 1'000; }
    /// Samples everything, the items of an image from the pinned scan. `has_lost`: scans before it
    /// were not sampled.
    void sample_scan(const ImagePin& pin, TimePoint now, bool has_lost);

private:
    enum class Binding : std::uint8_t {
        Unknown,
        AddressSpace, // or an attribute that cannot be read
        Source,
    };
    struct Member {
        ValueItem* item;
        std::uint64_t handle{0};
        std::uint32_t source{model::no_source};
        Binding binding{Binding::Unknown};
        bool is_cut_by_source{false};
    };
    /// A pending batch.
    struct Flight;

    void sample(TimePoint now);
    void sample_new_members(TimePoint now);
    [[nodiscard]] WatchedImages::Sample image_sample(bool is_only_new) const;
    /// Requests one batch from each source, for the members from `first` to before `end`.
    void sample_members(std::size_t first, std::size_t end, TimePoint now, bool is_late);
    /// Index of the first member whose value is pending; past the last one if there is none.
    [[nodiscard]] std::size_t first_in_flight() const;
    void ask(Flight& flight, std::size_t member);
    void ask_unbound(Flight& flight, std::size_t member);
    void deliver(Flight& flight);
    void land(Flight& flight);
    void handle_flights(TimePoint now);
    void notice_changes();
    /// Finds the sources of values; the items of a process image go to its watch.
    void bind(std::size_t first);
    void bind_one(std::size_t member);
    /// Updates what the item monitors, for the source.
    void note_source(ValueItem& item, const ReadPlan& plan);
    void set_use(ValueItem& item, const MonitoredHandles::Use& use);
    /// Returns a place for the item.
    [[nodiscard]] ValueItem::Place put_in(ValueItem& item);
    void take_out(ValueItem& item);
    void compact();
    [[nodiscard]] bool is_full_of_holes() const;
    void arm();

    Sampler& sampler_;
    Duration interval_;
    Duration actual_interval_{0};
    TimePoint last_sample_{no_deadline};
    TimePoint next_sample_{no_deadline};
    std::size_t item_count_{0};
    /// A removed item leaves an empty member; these are removed while no batch is pending.
    std::vector<Member> members_;
    std::size_t holes_{0};
    /// Members from here on have no sample yet.
    std::size_t first_new_{0};
    bool is_late_{false};
    std::vector<std::unique_ptr<Flight>> flights_;
    WatchedImages images_;
    std::uint64_t lookups_;
};

} // namespace busbar::server::detail
