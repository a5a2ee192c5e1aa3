#include "value_item.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/core/detail/guarded.hpp>

#include "sampler.hpp"
#include "sampling_context.hpp"
#include "server/data/read_results.hpp"
#include "subscription.hpp"
#include "subscription_table.hpp"

namespace busbar::server::detail {

namespace {

/// The statuses that make an item impossible. All other answers of a Read come with a Publish
/// response, because they may change (Part 4, 5.13.2.1).
constexpr std::array refusals{
    status::Bad_NodeIdInvalid,       status::Bad_NodeIdUnknown,
    status::Bad_AttributeIdInvalid,  status::Bad_IndexRangeInvalid,
    status::Bad_DataEncodingInvalid, status::Bad_DataEncodingUnsupported,
};

bool is_value_of_variable(const model::AddressSpace& space, const ReadTarget& target,
                          model::NodeIndex node)
{
    return target.attribute_id == static_cast<std::uint32_t>(AttributeId::Value) &&
           node != model::no_node && space.node_class(node) == NodeClass::Variable;
}

/// Returns true if an array of this size never has the elements of the range (Part 4, 5.13.2.4).
bool is_past_the_end(const NumericRange& range, std::span<const std::uint32_t> dimensions)
{
    const auto bounds = range.bounds();
    for (std::size_t i = 0; i < std::min(bounds.size(), dimensions.size()); ++i) {
        if (dimensions[i] != 0 && bounds[i].first >= dimensions[i]) {
            return true;
        }
    }
    return false;
}

/// Upper bound of a notification's encoded size with this value.
std::size_t size_with(const Variant& value)
{
    // Handle, mask, status, timestamps and a scalar.
    constexpr std::size_t most_flat = 64;
    return held_bytes(value) == 0 ? most_flat : most_flat + binary::encoded_size(value);
}

/// Returns the interval of the Variable whose value is monitored; 0 for all else.
double minimum_sampling_interval(const model::AddressSpace& space, const ReadTarget& target)
{
    const model::NodeIndex node = space.find(target.node_id);
    return is_value_of_variable(space, target, node)
               ? space.variable(node).minimum_sampling_interval
               : 0;
}

} // namespace

ValueItem::ValueItem(const ItemContext& context, const MonitoredItemCreateRequest& request,
                     TimestampsToReturn timestamps)
    : MonitoredItem{context.subscription, Kind::Data, request.requested_parameters.client_handle,
                    request.monitoring_mode},
      timestamps_{timestamps},
      attribute_id_{request.item_to_monitor.attribute_id}, node_id_{request.item_to_monitor.node_id}
{
    if (!request.item_to_monitor.data_encoding.name.empty()) {
        extras().data_encoding = request.item_to_monitor.data_encoding;
    }
}

const SubscriptionNeeds& ValueItem::needs() const
{
    return subscription().all().needs();
}

ValueItem::~ValueItem()
{
    if (group_ != nullptr) {
        remove_from_group(*this);
    }
    subscription().all().sampler().intervals().change(counted(mode()), {});
    queue_.release(subscription().memory());
    subscription().memory().release(is_charged_ ? cost() : 0);
    if (charged_source_ != nullptr) {
        charged_source_->release_monitored(monitored_size_);
    }
}

void ValueItem::node_changed(model::NodeIndex /*node*/, bool /*is_removed*/)
{
    node_changed_in_group(*this);
}

std::unique_ptr<ValueItem> ValueItem::make(const ItemContext& context,
                                           const MonitoredItemCreateRequest& request,
                                           TimestampsToReturn timestamps, ItemRevision& revision)
{
    std::unique_ptr<ValueItem> item{new ValueItem{context, request, timestamps}};
    ReadPlan plan;
    revision.status = item->check_target(context, request.item_to_monitor.index_range, plan);
    if (revision.status.is_bad()) {
        return nullptr;
    }
    const MonitoringParameters& parameters = request.requested_parameters;
    auto filter = item->make_filter(parameters.filter);
    if (!filter) {
        revision.status = filter.error();
        return nullptr;
    }
    item->keep_filter(parameters.filter, *filter);
    item->is_charged_ = context.subscription.memory().charge(item->cost());
    if (!item->is_charged_) {
        revision.status = status::Bad_TooManyMonitoredItems;
        return nullptr;
    }
    revision.status = item->charge_source(plan);
    if (revision.status.is_bad()) {
        return nullptr;
    }
    item->revise(context, parameters, timestamps, plan, revision);
    return item;
}

// There may be hundreds of thousands of them.
static_assert(sizeof(void*) != 8 || sizeof(ValueItem) <= 272);

std::size_t ValueItem::cost() const
{
    const ReadTarget read = target();
    const std::size_t of_encoding =
        read.has_default_encoding() ? 0 : binary::encoded_size(*read.data_encoding);
    return sizeof(ValueItem) + sizeof(Extras) + 2 * sizeof(void*) * 8 +
           MonitoredHandles::bytes_per_item + model::node_watch_memory +
           2 * (binary::encoded_size(node_id_) + of_encoding) +
           (range() != nullptr ? sizeof(NumericRange) : 0);
}

StatusCode ValueItem::charge_source(const ReadPlan& plan)
{
    if (plan.source == nullptr) {
        return status::Good;
    }
    const Result<std::size_t> size = plan.source->charge_monitored(plan.handle);
    if (!size) {
        return size.error();
    }
    charged_source_ = plan.source;
    monitored_size_ = *size;
    return status::Good;
}

StatusCode ValueItem::check_target(const ItemContext& context, const String& index_range,
                                   ReadPlan& plan)
{
    plan = plan_sample(needs(), context.subscription, target());
    const StatusCode status = plan.answer.status;
    if (std::find(refusals.begin(), refusals.end(), status) != refusals.end()) {
        return status;
    }
    if (index_range.empty()) {
        return status::Good;
    }
    const auto range = NumericRange::parse(index_range.view());
    if (!range) {
        return range.error();
    }
    const model::NodeIndex node = this->node();
    if (is_value_of_variable(needs().space, target(), node) &&
        is_past_the_end(*range, needs().space.variable(node).array_dimensions)) {
        return status::Bad_IndexRangeNoData;
    }
    extras().range = std::make_shared<const NumericRange>(*range);
    return status::Good;
}

Result<ChangeFilter> ValueItem::make_filter(const ExtensionObject& filter)
{
    const model::NodeIndex node = this->node();
    if (!filter.is_null() && !is_value_of_variable(needs().space, target(), node)) {
        return fail(status::Bad_FilterNotAllowed); // Part 4, 5.13.1.1
    }
    std::optional<Range> eu_range;
    if (ChangeFilter::is_percentage(filter) && node != model::no_node) {
        eu_range = look_up_eu_range(node);
    }
    return ChangeFilter::make(filter, needs().space, node, eu_range);
}

ValueItem::Extras& ValueItem::extras()
{
    if (extras_ == nullptr) {
        extras_ = std::make_unique<Extras>(*this);
    }
    return *extras_;
}

void ValueItem::keep_filter(const ExtensionObject& text, const ChangeFilter& filter)
{
    if (!text.is_null()) {
        Filtered& kept = extras().filtered;
        kept.text = text; // first, as it may fail
        kept.filter = filter;
    } else if (range() != nullptr || !target().has_default_encoding()) {
        extras_->filtered = {};
    } else {
        extras_.reset();
    }
}

/// Until a source has returned the range, one without width, so that all changes are reported.
std::optional<Range> ValueItem::look_up_eu_range(model::NodeIndex variable)
{
    const model::AddressSpace& space = needs().space;
    const model::NodeIndex property = find_eu_range(space, variable);
    if (property == model::no_node || space.node_class(property) != NodeClass::Variable) {
        return std::nullopt;
    }
    const model::VariableAttributes attributes = space.variable(property);
    if (needs().sources.find(attributes.source) != nullptr) {
        auto read = std::make_unique<EuRangeRead>(extras(), needs().sources);
        Filtered& kept = extras().filtered;
        kept.eu_range = Range{};
        kept.read = std::move(read);
        // Its deadline is ignored; an answer is welcome at any time.
        kept.read->start(attributes, TimePoint{});
        return kept.eu_range;
    }
    return binary::structure_of<Range>(space.value(property, &needs().types));
}

void ValueItem::eu_range_came(const std::optional<Range>& range)
{
    Filtered& kept = extras_->filtered;
    kept.eu_range = range;
    const auto done = std::move(kept.read);
    const model::NodeIndex node = this->node();
    if (node == model::no_node || !ChangeFilter::is_percentage(kept.text)) {
        return;
    }
    if (auto filter = ChangeFilter::make(kept.text, needs().space, node, range)) {
        kept.filter = *filter;
    }
}

void ValueItem::revise(const ItemContext& context, const MonitoringParameters& parameters,
                       TimestampsToReturn timestamps, const ReadPlan& plan, ItemRevision& revision)
{
    const SubscriptionLimits& limits = needs().limits.subscriptions;
    timestamps_ = timestamps;
    const Duration interval = limits.sampling.revise(
        parameters.sampling_interval, context.subscription.parameters().publishing_interval,
        can_follow_scans(needs(), plan), minimum_sampling_interval(needs().space, target()));
    // 0 and 1 are the same (Part 4, 7.21).
    const std::uint32_t capacity = std::min(parameters.queue_size, limits.max_queue_size);
    revision.queue_size =
        queue_.set_capacity(capacity, parameters.discard_oldest, subscription().memory());
    revision.sampling_interval = to_milliseconds(interval);
    set_interval(interval);
}

std::optional<SamplingIntervals::Use> ValueItem::counted(MonitoringMode mode) const
{
    if (!is_counted_) {
        return std::nullopt;
    }
    return SamplingIntervals::Use{mode == MonitoringMode::Disabled, interval_};
}

void ValueItem::set_interval(Duration interval)
{
    const SamplingIntervals::Use next{mode() == MonitoringMode::Disabled, interval};
    subscription().all().sampler().intervals().change(counted(mode()), next);
    is_counted_ = true;
    interval_ = interval;
}

void ValueItem::modify(const ItemContext& context, const MonitoringParameters& parameters,
                       TimestampsToReturn timestamps, ItemRevision& revision)
{
    auto filter = make_filter(parameters.filter);
    if (!filter) {
        revision.status = filter.error();
        return;
    }
    keep_filter(parameters.filter, *filter);
    set_client_handle(parameters.client_handle);
    const Duration before = interval_;
    // So that the same change counts as one the next time, too.
    busbar::detail::Undo undo{[&] { set_interval(before); }};
    const ReadPlan plan = plan_sample(needs(), context.subscription, target());
    revise(context, parameters, timestamps, plan, revision);
    if (before != interval_ && group_ != nullptr) {
        context.all.sampler().add(*this, context.now);
    }
    undo.keep();
}

void ValueItem::mode_changed(const ItemContext& context, MonitoringMode before)
{
    if (mode() == MonitoringMode::Disabled) {
        remove_from_group(*this);
    } else if (before == MonitoringMode::Disabled) {
        context.all.sampler().add(*this, context.now);
    }
    context.all.sampler().intervals().change(counted(before), counted(mode()));
}

void ValueItem::user_changed(const ItemContext&)
{
    const ReadPlan plan = plan_sample(needs(), subscription(), target());
    if (plan.source == nullptr && plan.answer.status.is_bad()) {
        // The new user must not see values that the previous one was allowed to see.
        queue_.clear(subscription().memory());
        subscription().ready(Kind::Data).remove(*this);
    }
    if (group_ != nullptr) {
        rebind_in_group(*this);
    }
}

void ValueItem::resend(const ItemContext&)
{
    if (queue_.size() == 0 && queue_.newest() != nullptr) {
        queue_.repeat();
        notify();
    }
}

void ValueItem::announce_change(std::uint32_t status_bits)
{
    pending_bits_ |= status_bits;
    // An EURange that has become unusable leaves the deadband unchanged.
    if (extras_ != nullptr) {
        if (auto filter = make_filter(extras_->filtered.text)) {
            extras_->filtered.filter = *filter;
        }
    }
    if (group_ != nullptr) {
        rebind_in_group(*this);
    }
}

void ValueItem::sample(const ReadSlot& slot, StatusCode status, DateTime server_time)
{
    const Variant& value = slot.shared != nullptr ? *slot.shared : slot.value;
    const DataValue* const last = queue_.newest();
    if (last != nullptr && pending_bits_ == 0 && !filter().passes(*last, slot, value, status)) {
        return;
    }
    const std::uint32_t bits = pending_bits_ | (has_lost_ ? ValueQueue::overflow_bits : 0U);
    if (queue_.push(slot, value, StatusCode{status.value() | bits}, server_time,
                    subscription().memory())) {
        subscription().count(&SubscriptionDiagnosticsDataType::monitoring_queue_overflow_count);
    }
    pending_bits_ = 0;
    has_lost_ = false;
    notify();
}

void ValueItem::note_loss()
{
    has_lost_ = queue_.capacity() > 1 && queue_.newest() != nullptr;
    if (has_lost_) {
        subscription().count(&SubscriptionDiagnosticsDataType::monitoring_queue_overflow_count);
    }
}

void ValueItem::clear()
{
    queue_.clear(subscription().memory());
    has_lost_ = false;
}

std::size_t ValueItem::notification_size() const
{
    return size_with(queue_.oldest().value);
}

void ValueItem::take_notification(binary::Writer& writer, std::size_t most)
{
    const DataValue& oldest = queue_.oldest();
    writer.number(client_handle());
    if (size_with(oldest.value) <= most) {
        encode_data_value(writer, oldest, oldest.value, {timestamps_, oldest.server_timestamp});
    } else {
        DataValue reason{status::Bad_EncodingLimitsExceeded};
        reason.source_timestamp = oldest.source_timestamp;
        encode_data_value(writer, reason, reason.value, {timestamps_, oldest.server_timestamp});
    }
    queue_.pop();
    subscription().count(&SubscriptionDiagnosticsDataType::data_change_notifications_count);
}

} // namespace busbar::server::detail
