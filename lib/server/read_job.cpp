#include "read_job.hpp"

#include <algorithm>
#include <cmath>

#include <busbar/binary/codec.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::server::detail {

namespace {

constexpr auto value_attribute = static_cast<std::uint32_t>(AttributeId::Value);

/// A null DataEncoding is the default one. Bad_DataEncodingInvalid where none can be asked for,
/// Bad_DataEncodingUnsupported for a structure's that is not the one of this protocol.
StatusCode check_data_encoding(const ReadContext& context, const ReadValueId& id,
                               const model::VariableAttributes* variable)
{
    if (id.data_encoding.name.empty()) {
        return status::Good;
    }
    if (variable == nullptr) {
        return status::Bad_DataEncodingInvalid;
    }
    if (id.data_encoding.namespace_index == 0 && id.data_encoding.name.view() == "Default Binary") {
        return status::Good;
    }
    return context.space.is_subtype_of(variable->data_type, id::Structure)
               ? status::Bad_DataEncodingUnsupported
               : status::Bad_DataEncodingInvalid;
}

StatusCode check_access(const ReadContext& context, const ReadValueId& id,
                        const model::VariableAttributes& variable)
{
    if (!has_access(variable.access_level, AccessLevelType::CurrentRead)) {
        return status::Bad_NotReadable;
    }
    const std::uint8_t level = context.rights.access_level(id.node_id, variable);
    return has_access(level, AccessLevelType::CurrentRead) ? status::Good
                                                           : status::Bad_UserAccessDenied;
}

/// Any attribute but a Variable's Value.
Result<Variant> attribute(const ReadContext& context, const ReadValueId& id, model::NodeIndex node)
{
    const model::AddressSpace& space = context.space;
    const auto attribute_id = static_cast<AttributeId>(id.attribute_id);
    if (attribute_id == AttributeId::Value) {
        Variant value = space.value(node);
        if (space.node_class(node) != NodeClass::VariableType || value.is_null()) {
            return fail(status::Bad_AttributeIdInvalid);
        }
        return value;
    }
    if (attribute_id == AttributeId::UserAccessLevel &&
        space.node_class(node) == NodeClass::Variable) {
        return Variant{context.rights.access_level(id.node_id, space.variable(node))};
    }
    return space.attribute(node, attribute_id);
}

/// The value of a Variable without source.
DataValue kept_value(const ReadContext& context, const ReadValueId& id, model::NodeIndex node)
{
    if (id.node_id.namespace_index() == 0) {
        if (auto live = context.live_value(id.node_id)) {
            return std::move(*live);
        }
    }
    return DataValue{context.space.value(node)};
}

/// A maxAge of the largest Int32 or more asks for any value that is there (Part 4, 5.11.2.2).
std::chrono::milliseconds to_max_age(double milliseconds)
{
    return std::chrono::milliseconds{
        static_cast<std::int64_t>(std::min<double>(milliseconds, INT32_MAX))};
}

} // namespace

StatusCode check_read(const ReadRequest& request, std::size_t max_nodes)
{
    if (request.nodes_to_read.empty()) {
        return status::Bad_NothingToDo;
    }
    if (request.nodes_to_read.size() > max_nodes) {
        return status::Bad_TooManyOperations;
    }
    if (request.timestamps_to_return < TimestampsToReturn::Source ||
        request.timestamps_to_return > TimestampsToReturn::Neither) {
        return status::Bad_TimestampsToReturnInvalid;
    }
    // Also true of a maxAge that is not a number.
    return request.max_age >= 0 ? status::Good : status::Bad_MaxAgeInvalid;
}

ReadJob::ReadJob(const ReadContext& context, const ReadRequest& request)
    : call_{context.sources, request.nodes_to_read.size()},
      timestamps_{request.timestamps_to_return, context.server_time}, max_age_{to_max_age(
                                                                          request.max_age)}
{
    const auto ids = request.nodes_to_read.span();
    for (std::size_t i = 0; i < ids.size(); ++i) {
        plan(context, i, ids[i]);
    }
}

void ReadJob::plan(const ReadContext& context, std::size_t index, const ReadValueId& id)
{
    const model::NodeIndex node = context.space.find(id.node_id);
    if (node == model::no_node || !context.rights.may_see(id.node_id)) {
        call_.answer(index).status = why_not_found(id.node_id);
        return;
    }
    if (id.attribute_id == value_attribute &&
        context.space.node_class(node) == NodeClass::Variable) {
        return plan_value(context, index, id, node);
    }
    ReadSlot& slot = call_.answer(index);
    Result<Variant> value = attribute(context, id, node);
    slot.status = value ? check_data_encoding(context, id, nullptr) : value.error();
    if (slot.status.is_good()) {
        slot.value = std::move(*value);
        if (const auto range = keep_range(index, id.index_range); !range) {
            slot.status = range.error();
        }
    }
}

void ReadJob::plan_value(const ReadContext& context, std::size_t index, const ReadValueId& id,
                         model::NodeIndex node)
{
    const model::VariableAttributes variable = context.space.variable(node);
    StatusCode refusal = check_access(context, id, variable);
    if (refusal.is_good()) {
        refusal = check_data_encoding(context, id, &variable);
    }
    const Result<NumericRange*> range = keep_range(index, id.index_range);
    if (refusal.is_good() && !range) {
        refusal = range.error();
    }
    if (refusal.is_bad()) {
        call_.answer(index).status = refusal;
        return;
    }
    if (variable.source == model::no_source) {
        call_.answer(index) = kept_value(context, id, node);
        return;
    }
    const auto* source = context.sources.find(variable.source);
    if (source == nullptr) {
        call_.answer(index).status = status::Bad_NoCommunication;
        return;
    }
    const bool is_cut_by_source = *range != nullptr && (*source)->options().reads_ranges;
    if (is_cut_by_source) {
        ranges_->back().is_cut_here = false;
    }
    call_.ask(index, variable.source, {variable.handle, is_cut_by_source ? *range : nullptr});
}

Result<NumericRange*> ReadJob::keep_range(std::size_t index, const String& text)
{
    if (text.empty()) {
        return nullptr;
    }
    auto range = NumericRange::parse(text.view());
    if (!range) {
        return fail(range.error());
    }
    if (ranges_ == nullptr) {
        ranges_ = std::make_shared<std::vector<Range>>();
        // It must not move: sources are given the addresses.
        ranges_->reserve(call_.size() - index);
    }
    return &ranges_->emplace_back(Range{*range, index, true}).range;
}

bool ReadJob::start(CallOwner& owner, TimePoint now)
{
    call_.kept_for_sources() = ranges_;
    return call_.start(owner, now, [&](ReadPart& part) { part.max_age = max_age_; });
}

void ReadJob::finish()
{
    if (ranges_ == nullptr) {
        return;
    }
    for (const Range& range : *ranges_) {
        ReadSlot* const slot = range.is_cut_here ? call_.find_answer(range.index) : nullptr;
        if (slot != nullptr) {
            cut_range(*slot, range.range);
        }
    }
}

void ReadJob::encode_results(binary::Writer& writer) const
{
    writer.length(call_.size());
    for (std::size_t i = 0; i < call_.size(); ++i) {
        encode_slot(writer, call_.result(i), timestamps_);
    }
    encode(writer, Array<DiagnosticInfo>{});
}

} // namespace busbar::server::detail
