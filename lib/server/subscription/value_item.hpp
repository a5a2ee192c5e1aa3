#pragma once

#include <memory>
#include <optional>

#include <busbar/core/numeric_range.hpp>
#include <busbar/server/data_source.hpp>

#include "change_filter.hpp"
#include "eu_range.hpp"
#include "monitored_handles.hpp"
#include "monitored_item.hpp"
#include "sampling_intervals.hpp"
#include "server/rights/read_plan.hpp"
#include "subscription_needs.hpp"
#include "value_queue.hpp"

namespace busbar::server::detail {

class SamplingGroup;

/// An item of an attribute, mostly a Variable's Value: samples come from its SamplingGroup, pass
/// the filter and wait in a queue.
class ValueItem final : public MonitoredItem, private model::NodeWatch {
public:
    /// Where an item is in its sampling group.
    struct Place {
        static constexpr std::uint32_t no_image = UINT32_MAX;
        /// Of the group's images the one whose watch has the item.
        std::uint32_t image{no_image};
        /// In that watch, else among the group's members.
        std::uint32_t index{0};
    };

    /// Null, with the reason in `revision.status`, if there can be no such item. It is sampled from
    /// add_to_sampler() on.
    [[nodiscard]] static std::unique_ptr<ValueItem> make(const ItemContext& context,
                                                         const MonitoredItemCreateRequest& request,
                                                         TimestampsToReturn timestamps,
                                                         ItemRevision& revision);
    ~ValueItem() override;

    [[nodiscard]] std::size_t queued() const override { return queue_.size(); }
    void fetch_notification() const override { busbar::detail::fetch_object(queue_.oldest()); }
    [[nodiscard]] std::size_t notification_size() const override;
    void take_notification(binary::Writer& writer, std::size_t most) override;
    void modify(const ItemContext& context, const MonitoringParameters& parameters,
                TimestampsToReturn timestamps, ItemRevision& revision) override;
    void user_changed(const ItemContext& context) override;
    void resend(const ItemContext& context) override;

    // For the sampler.

    [[nodiscard]] const NodeId& node_id() const { return node_id_; }
    [[nodiscard]] ReadTarget target() const
    {
        return {node_id_, attribute_id_, extras_ != nullptr ? &extras_->data_encoding : nullptr};
    }
    /// Zero: each scan of a process image.
    [[nodiscard]] Duration interval() const { return interval_; }
    /// Null if the whole value is wanted.
    [[nodiscard]] const NumericRange* range() const
    {
        return extras_ != nullptr ? extras_->range.get() : nullptr;
    }
    /// The same, for who may look at it after the item is gone. Not without a range.
    [[nodiscard]] const std::shared_ptr<const NumericRange>& shared_range() const
    {
        return extras_->range;
    }
    /// True if two equal samples are never both reported.
    [[nodiscard]] bool ignores_equal() const
    {
        return !filter().looks_at_time() && pending_bits_ == 0 && queue_.newest() != nullptr;
    }
    /// One sample, whose range is cut already: queues it if it passes the filter.
    void sample(const ReadSlot& slot, StatusCode status, DateTime server_time);

    /// Values may have been lost before they could be queued: the next one that is has the Overflow
    /// bit, as if they had been lost in the queue (Part 4, 5.13.1.5). Not in a queue of one.
    void note_loss();

    /// The next sample is reported whatever it is, with these bits of its status set (Part 4,
    /// 7.38.1; Part 8, 5.2). A filter in percent looks for the EURange again.
    void announce_change(std::uint32_t status_bits);
    /// Has brought near from memory what sample() is going to look at.
    void fetch_queue() const { queue_.fetch(); }

private:
    friend class SamplingGroup;

    /// What belongs to a filter of the client's.
    struct Filtered {
        ChangeFilter filter;
        /// As it was given, for when the EURange changes.
        ExtensionObject text;
        std::optional<Range> eu_range;
        /// Null unless a source is asked for the EURange.
        std::unique_ptr<EuRangeRead> read;
    };
    /// What few items have.
    struct Extras final : EuRangeUser {
        explicit Extras(ValueItem& owner) : item{owner} {}
        void eu_range_came(const std::optional<Range>& value) override
        {
            item.eu_range_came(value);
        }

        ValueItem& item;
        std::shared_ptr<const NumericRange> range;
        QualifiedName data_encoding;
        Filtered filtered;
    };

    ValueItem(const ItemContext& context, const MonitoredItemCreateRequest& request,
              TimestampsToReturn timestamps);

    [[nodiscard]] const SubscriptionNeeds& needs() const;
    [[nodiscard]] model::NodeIndex node() const { return needs().space.find(node_id_); }
    [[nodiscard]] ChangeFilter filter() const
    {
        return extras_ != nullptr ? extras_->filtered.filter : ChangeFilter{};
    }
    /// Makes what is not there yet.
    [[nodiscard]] Extras& extras();
    void clear() override;
    void mode_changed(const ItemContext& context, MonitoringMode before) override;
    /// What the item takes at most, besides what is queued: each may get a filter later. Always the
    /// same.
    [[nodiscard]] std::size_t cost() const;
    [[nodiscard]] StatusCode charge_source(const ReadPlan& plan);
    [[nodiscard]] StatusCode check_target(const ItemContext& context, const String& index_range,
                                          ReadPlan& plan);
    [[nodiscard]] Result<ChangeFilter> make_filter(const ExtensionObject& filter);
    void keep_filter(const ExtensionObject& text, const ChangeFilter& filter);
    [[nodiscard]] std::optional<Range> look_up_eu_range(model::NodeIndex variable);
    void eu_range_came(const std::optional<Range>& range);
    /// Where the group gets the item's values from may be wrong by now.
    void node_changed(model::NodeIndex node, bool is_removed) override;
    [[nodiscard]] std::optional<SamplingIntervals::Use> counted(MonitoringMode mode) const;
    void set_interval(Duration interval);
    /// Queue, interval and timestamps.
    void revise(const ItemContext& context, const MonitoringParameters& parameters,
                TimestampsToReturn timestamps, const ReadPlan& plan, ItemRevision& revision);

    // What each sample looks at lies together; the flags in bytes that NodeWatch leaves free.

    bool has_lost_{false};
    bool is_charged_{false};
    /// In SamplingIntervals, by mode and interval.
    bool is_counted_{false};
    std::uint32_t pending_bits_{0};
    TimestampsToReturn timestamps_;
    std::uint32_t attribute_id_;
    /// With used_handle_, the MonitoredHandles::Use of the item in its group.
    std::uint32_t used_source_{model::no_source};
    std::unique_ptr<Extras> extras_;
    ValueQueue queue_;

    NodeId node_id_;
    Duration interval_{0};
    /// Null, or which source counts the item, and as what.
    SourceEntry* charged_source_{nullptr};
    std::size_t monitored_size_{0};

    // The sampling group's: where the item is in it.

    SamplingGroup* group_{nullptr};
    Place place_;
    std::uint64_t used_handle_{0};
};

} // namespace busbar::server::detail
