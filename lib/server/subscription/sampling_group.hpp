#pragma once

#include <memory>
#include <vector>

#include "server/data/data_call.hpp"
#include "timer_queue.hpp"
#include "value_item.hpp"
#include "watched_images.hpp"

namespace busbar::server::detail {

class Sampler;

/// The data items with one sampling interval: at each, the values of one source are asked for in
/// one batch, those of a process image are looked at where they lie, and everything else is found
/// in the address space.
class SamplingGroup final : public Timer {
public:
    /// `interval` is zero for the items that follow the scans of one image.
    SamplingGroup(Sampler& sampler, Duration interval);
    SamplingGroup(const SamplingGroup&) = delete;
    SamplingGroup& operator=(const SamplingGroup&) = delete;
    ~SamplingGroup() override;

    [[nodiscard]] Duration interval() const { return interval_; }
    /// Between the last two samples; zero before the second.
    [[nodiscard]] Duration actual_interval() const { return actual_interval_; }
    [[nodiscard]] bool empty() const { return item_count_ == 0; }
    /// The source of an image that is looked at is gone. The next sample finds that out for its
    /// items, and lets the image go.
    [[nodiscard]] bool has_lost_source() const { return images_.has_lost_source(); }
    /// The group that the item is in; null if it is in none.
    [[nodiscard]] static SamplingGroup* of(const ValueItem& item) { return item.group_; }

    /// Takes the item from the group that it is in. Where there is no memory it stays there.
    void add(ValueItem& item, TimePoint now);
    void remove(ValueItem& item);
    /// What the item was bound to is looked up again.
    void rebind(ValueItem& item);
    /// The same, to be called from the item's NodeWatch.
    void node_changed(ValueItem& item);
    /// Finds out where the values of what was added since the last sample come from.
    void bind_new();
    /// Samples it; behind bind_new().
    void sample_new(TimePoint now);
    /// The same, the items of an image from the scan that is pinned.
    void sample_new(const ImagePin& pin, TimePoint now);
    void expire(TimePoint now) override;
    /// Sampling comes before publishing.
    [[nodiscard]] unsigned rank() const override { return 1'000; }
    /// Samples everything, the items of an image from the scan that is pinned. `has_lost`: there
    /// were scans before it that nobody looked at.
    void sample_scan(const ImagePin& pin, TimePoint now, bool has_lost);

private:
    enum class Binding : std::uint8_t {
        Unknown,
        AddressSpace, // or nothing that could be read
        Source,
    };
    struct Member {
        ValueItem* item;
        std::uint64_t handle{0};
        std::uint32_t source{model::no_source};
        Binding binding{Binding::Unknown};
        bool is_cut_by_source{false};
    };
    /// A batch on its way.
    struct Flight;

    void sample(TimePoint now);
    void sample_new_members(TimePoint now);
    [[nodiscard]] WatchedImages::Sample image_sample(bool is_only_new) const;
    /// One batch for each source, of the members from `first` to before `end`.
    void sample_members(std::size_t first, std::size_t end, TimePoint now, bool is_late);
    /// The first member whose value is on its way; past the last one if there is none.
    [[nodiscard]] std::size_t first_in_flight() const;
    void ask(Flight& flight, std::size_t member);
    void ask_unbound(Flight& flight, std::size_t member);
    void deliver(Flight& flight);
    void land(Flight& flight);
    void handle_flights(TimePoint now);
    void notice_changes();
    /// Finds out where values come from; the items of a process image go to its watch.
    void bind(std::size_t first);
    void bind_one(std::size_t member);
    /// Keeps account of what the item monitors, for the source.
    void note_source(ValueItem& item, const ReadPlan& plan);
    void set_use(ValueItem& item, const MonitoredHandles::Use& use);
    /// The place that is to be the item's.
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
    /// Members have no item where one was removed; they close up while no batch is on its way.
    std::vector<Member> members_;
    std::size_t holes_{0};
    /// Those from here on have no sample yet.
    std::size_t first_new_{0};
    bool is_late_{false};
    std::vector<std::unique_ptr<Flight>> flights_;
    WatchedImages images_;
    std::uint64_t lookups_;
};

} // namespace busbar::server::detail
