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

/// An item of an attribute, usually a Variable's Value: samples come from its SamplingGroup, pass
/// the filter and wait in a queue.
class ValueItem final : public MonitoredItem, private model::NodeWatch {
public:
    /// The place of an item in its sampling group.
    struct Place {
        static constexpr std::uint32_t no_image = UINT32_MAX;
        /// Index of the group's image whose watch has the item.
        std::uint32_t image{no_image};
        /// Index in that watch, else among the group's members.
        std::uint32_t index{0};
    };

    /// Returns null, with the reason in `revision.status`, if such an item is impossible. It is
    /// sampled from add_to_sampler() on.
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

    // Called by the sampler.

    [[nodiscard]] const NodeId& node_id() const { return node_id_; }
    [[nodiscard]] ReadTarget target() const
    {
        return {node_id_, attribute_id_, extras_ != nullptr ? &extras_->data_encoding : nullptr};
    }
    /// Zero means each scan of a process image, as does an interval of one scan.
    [[nodiscard]] Duration interval() const { return interval_; }
    /// Returns null for the whole value.
    [[nodiscard]] const NumericRange* range() const
    {
        return extras_ != nullptr ? extras_->range.get() : nullptr;
    }
    /// Returns the range for code that may use it after the item is destroyed. There must be a
    /// range.
    [[nodiscard]] const std::shared_ptr<const NumericRange>& shared_range() const
    {
        return extras_->range;
    }
    /// True if two equal samples are never both reported.
    [[nodiscard]] bool ignores_equal() const
    {
        return !filter().looks_at_time() && pending_bits_ == 0 && queue_.newest() != nullptr;
    }
    /// Takes one sample, whose range is already cut: queues it if it passes the filter.
    void sample(const ReadSlot& slot, StatusCode status, DateTime server_time);

    /// Values may have been lost before they could be queued: the next queued one has the Overflow
    /// bit, as if they had been lost in the queue (Part 4, 5.13.1.5). Not in a queue of one.
    void note_loss();

    /// The next sample is reported in any case, with these bits of its status set (Part 4, 7.38.1;
    /// Part 8, 5.2). A filter in percent reads the EURange again.
    void announce_change(std::uint32_t status_bits);
    /// Prefetches what sample() is going to use.
    void fetch_queue() const { queue_.fetch(); }

private:
    friend class SamplingGroup;

    /// The data of a client's filter.
    struct Filtered {
        ChangeFilter filter;
        /// The requested filter, for a change of the EURange.
        ExtensionObject text;
        std::optional<Range> eu_range;
        /// Null unless a source is being asked for the EURange.
        std::unique_ptr<EuRangeRead> read;
    };
    /// Data that few items have.
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
    /// Creates them on first use.
    [[nodiscard]] Extras& extras();
    void clear() override;
    void mode_changed(const ItemContext& context, MonitoringMode before) override;
    /// Maximum memory of the item, without its queue: each may get a filter later. Always the same.
    [[nodiscard]] std::size_t cost() const;
    [[nodiscard]] StatusCode charge_source(const ReadPlan& plan);
    [[nodiscard]] StatusCode check_target(const ItemContext& context, const String& index_range,
                                          ReadPlan& plan);
    [[nodiscard]] Result<ChangeFilter> make_filter(const ExtensionObject& filter);
    void keep_filter(const ExtensionObject& text, const ChangeFilter& filter);
    [[nodiscard]] std::optional<Range> look_up_eu_range(model::NodeIndex variable);
    void eu_range_came(const std::optional<Range>& range);
    /// The item's source may have changed.
    void node_changed(model::NodeIndex node, bool is_removed) override;
    [[nodiscard]] std::optional<SamplingIntervals::Use> counted(MonitoringMode mode) const;
    void set_interval(Duration interval);
    /// Revises queue, interval and timestamps.
    void revise(const ItemContext& context, const MonitoringParameters& parameters,
                TimestampsToReturn timestamps, const ReadPlan& plan, ItemRevision& revision);

    // Data that each sample uses is kept together; the flags in bytes that NodeWatch leaves free.

    bool has_lost_{false};
    bool is_charged_{false};
    /// Counted in SamplingIntervals, by mode and interval.
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
    /// The source that counts the item, and the counted size; null if there is none.
    SourceEntry* charged_source_{nullptr};
    std::size_t monitored_size_{0};

    // Used by the sampling group: the item's place in it.

    SamplingGroup* group_{nullptr};
    Place place_;
    std::uint64_t used_handle_{0};
};

} // namespace busbar::server::detail
