#include "write_job.hpp"

#include <algorithm>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/types/ids.hpp>

#include "server/rights/nodes_ahead.hpp"

namespace busbar::server::detail {

namespace {

StatusCode check_access(const WriteContext& context, model::NodeIndex node,
                        const model::VariableAttributes& variable)
{
    if (const StatusCode weak = context.rights.check_channel(node); weak.is_bad()) {
        return weak;
    }
    if (!has_access(variable.access_level, AccessLevelType::CurrentWrite)) {
        return status::Bad_NotWritable;
    }
    const std::uint8_t level = context.rights.access_level(node, variable);
    return has_access(level, AccessLevelType::CurrentWrite) ? status::Good
                                                            : status::Bad_UserAccessDenied;
}

/// Part 3, 8.57: without StatusWrite only Good can be written, without TimestampWrite no source
/// timestamp. A client never writes the server timestamp.
StatusCode check_quality(std::uint8_t access_level, const DataValue& data)
{
    const bool is_refused =
        (data.status != status::Good && !has_access(access_level, AccessLevelType::StatusWrite)) ||
        (!data.source_timestamp.is_null() &&
         !has_access(access_level, AccessLevelType::TimestampWrite)) ||
        !data.server_timestamp.is_null();
    return is_refused ? status::Bad_WriteNotSupported : status::Good;
}

/// True for an ExtensionObject without a type.
bool is_nothing(const Variant& value)
{
    const auto* const object = value.get_if<ExtensionObject>();
    return object != nullptr && object->is_null();
}

/// A part has the shape of its range, which is checked where it is replaced.
StatusCode check_type(const model::AddressSpace& space, const model::VariableAttributes& variable,
                      const Variant& value, bool is_part)
{
    if (is_nothing(value) && space.is_subtype_of(variable.data_type, id::Structure) &&
        !space.node_id(variable.data_type).is(id::Structure)) {
        return status::Bad_TypeMismatch;
    }
    if (!is_part) {
        return space.check_value(value, variable.data_type, variable.value_rank,
                                 variable.array_dimensions);
    }
    if (value.type() == BuiltInType::ExtensionObject) {
        constexpr std::int32_t any_rank = -2;
        return space.check_value(value, variable.data_type, any_rank, {});
    }
    const std::uint32_t types = space.built_in_types_of(variable.data_type);
    const bool fits =
        !value.is_null() && ((types >> static_cast<unsigned>(value.type())) & 1U) != 0;
    return fits ? status::Good : status::Bad_TypeMismatch;
}

/// Returns whether the Variable's source distinguishes a wrong length of an array.
bool has_fixed_lengths(const WriteContext& context, const model::VariableAttributes& variable)
{
    const auto* source = context.sources.find(variable.source);
    return source != nullptr && (*source)->options().has_fixed_lengths;
}

/// Returns whether only the array's length is wrong, and its source distinguishes that.
bool is_other_length(const WriteContext& context, const model::VariableAttributes& variable,
                     const Variant& value)
{
    return has_fixed_lengths(context, variable) && value.is_array() &&
           context.space.check_value(value, variable.data_type, variable.value_rank, {}).is_good();
}

/// Part 4, 5.11.4.2: a ByteString is accepted for an array of Byte.
bool stands_for_byte_array(const model::AddressSpace& space,
                           const model::VariableAttributes& variable, const Variant& value)
{
    return value.is_scalar() && value.type() == BuiltInType::ByteString &&
           space.built_in_type_of(variable.data_type) == BuiltInType::Byte;
}

StatusCode check_locales(const WriteContext& context, model::NodeIndex node, const Variant& value)
{
    if (value.type() != BuiltInType::LocalizedText) {
        return status::Good;
    }
    if (const auto* const text = value.get_if<LocalizedText>()) {
        return check_locale(context, node, AttributeId::Value, *text);
    }
    for (const LocalizedText& text : *value.array_if<LocalizedText>()) {
        const StatusCode bad = check_locale(context, node, AttributeId::Value, text);
        if (bad.is_bad()) {
            return bad;
        }
    }
    return status::Good;
}

/// Replaces a value in the address space, with its status and source timestamp (Part 4, 5.11.4.2),
/// the present time if the client sends none. `copied` is set to the bytes of the value that a
/// range is part of.
StatusCode replace_kept(const WriteContext& context, model::NodeIndex node,
                        const NumericRange* range, const DataValue& data, std::size_t& copied)
{
    DataValue whole{range != nullptr ? context.space.value(node) : data.value, data.status,
                    data.source_timestamp};
    whole.source_picoseconds = data.source_picoseconds;
    if (range != nullptr) {
        copied = binary::encoded_size(whole.value);
        if (const auto written = write_range(whole.value, *range, data.value); !written) {
            return written.error();
        }
    }
    if (whole.source_timestamp.is_null()) {
        whole.source_timestamp = context.now;
        whole.source_picoseconds = 0;
    }
    const bool is_text = whole.value.get_if<LocalizedText>() != nullptr;
    const auto set = is_text ? context.space.set_text(node, AttributeId::Value, std::move(whole))
                             : context.space.set_data_value(node, std::move(whole));
    if (!set) {
        return set.error();
    }
    context.definitions.replaced(context.space, node);
    return status::Good;
}

} // namespace

StatusCode check_write(const WriteRequest& request, std::size_t max_nodes)
{
    if (request.nodes_to_write.empty()) {
        return status::Bad_NothingToDo;
    }
    return request.nodes_to_write.size() > max_nodes ? status::Bad_TooManyOperations : status::Good;
}

WriteJob::WriteJob(DataSources& sources, const WriteRequest& request)
    : request_{request}, nodes_(request.nodes_to_write.size()),
      call_{sources, request.nodes_to_write.size()}, memory_{std::make_shared<Memory>()}
{
}

bool WriteJob::plan(const WriteContext& context, Turn& turn)
{
    rebindings_ = context.space.journal().rebindings();
    const auto values = request_.nodes_to_write.span();
    NodesAhead nodes{context.space, context.registered};
    do {
        if (!call_.is_answered(planned_)) {
            const model::NodeIndex node =
                nodes.find(values, planned_,
                           [](const WriteValue& value) -> const NodeId& { return value.node_id; });
            nodes_[planned_] =
                node != model::no_node ? context.space.handle(node) : model::NodeHandle{};
            if (const auto answer = plan_one(context, planned_, node)) {
                call_.answer(planned_) = *answer;
            }
        }
        turn.spend(Turn::units_of_value + std::exchange(copied_, 0));
        ++planned_;
    } while (planned_ < values.size() && !turn.is_over());
    return planned_ == values.size();
}

void WriteJob::plan_again()
{
    planned_ = 0;
    call_.take_back();
    // Values that ranges and conversions were kept for are in the address space or planned again.
    memory_->ranges.clear();
    memory_->converted.clear();
}

/// Returns nothing if a source will answer.
std::optional<StatusCode> WriteJob::plan_one(const WriteContext& context, std::size_t index,
                                             model::NodeIndex node)
{
    const WriteValue& value = request_.nodes_to_write[index];
    if (node == model::no_node || !context.rights.may_see(node)) {
        return why_not_found(value.node_id);
    }
    const auto attribute = static_cast<AttributeId>(value.attribute_id);
    if (attribute != AttributeId::Value || context.space.node_class(node) != NodeClass::Variable) {
        return write_attribute(context, node, value);
    }
    const Target target{node, context.space.variable(node)};
    const auto answer = plan_value(context, index, value, target);
    const auto* source = context.sources.find(target.variable.source);
    if (answer && source != nullptr && (*source)->options().all_or_nothing) {
        call_.refuse(target.variable.source, status::Bad_NoCommunication);
    }
    return answer;
}

std::optional<StatusCode> WriteJob::plan_value(const WriteContext& context, std::size_t index,
                                               const WriteValue& value, const Target& target)
{
    const model::VariableAttributes& variable = target.variable;
    if (const auto denied = check_access(context, target.node, variable); denied.is_bad()) {
        return denied;
    }
    const auto range = keep_range(index, value.index_range);
    if (!range) {
        return range.error();
    }
    const model::NodeAccess* const access = context.space.node_access(target.node);
    constexpr auto whole_only = static_cast<std::uint32_t>(AccessLevelExType::WriteFullArrayOnly);
    if (*range != nullptr && access != nullptr && (access->more_access_levels & whole_only) != 0) {
        return status::Bad_WriteNotSupported; // Part 3, 8.58
    }
    if (const auto bad = check_quality(variable.access_level, value.value); bad.is_bad()) {
        return bad;
    }
    const DataValue* data = &value.value;
    const bool is_part = *range != nullptr;
    if (stands_for_byte_array(context.space, variable, data->value)) {
        data = to_byte_array(*data);
    }
    const auto mismatch = check_type(context.space, variable, data->value, is_part);
    if (mismatch.is_bad()) {
        return is_other_length(context, variable, data->value) ? status::Bad_WriteNotSupported
                                                               : mismatch;
    }
    if (const auto bad = check_locales(context, target.node, data->value); bad.is_bad()) {
        return bad;
    }
    if (const auto bad = context.definitions.check(target.node, variable.data_type, data->value);
        bad.is_bad()) {
        const bool is_length = bad == status::Bad_OutOfRange &&
                               has_fixed_lengths(context, variable) &&
                               context.definitions.is_only_too_long(data->value);
        return is_length ? StatusCode{status::Bad_WriteNotSupported} : bad;
    }
    if (variable.source == model::no_source) {
        return replace_kept(context, target.node, *range, *data, copied_);
    }
    const auto* source = context.sources.find(variable.source);
    if (source == nullptr) {
        return status::Bad_NoCommunication;
    }
    if (is_part && !(*source)->options().writes_ranges) {
        return status::Bad_WriteNotSupported;
    }
    call_.ask(index, variable.source, {variable.handle, *range, data});
    return std::nullopt;
}

Result<const NumericRange*> WriteJob::keep_range(std::size_t index, const String& text)
{
    if (text.empty()) {
        return nullptr;
    }
    const auto range = NumericRange::parse(text.view());
    if (!range) {
        return fail(range.error());
    }
    if (memory_->ranges.empty()) {
        // It must not move, since sources get its addresses.
        memory_->ranges.reserve(call_.size() - index);
    }
    return &memory_->ranges.emplace_back(*range);
}

const DataValue* WriteJob::to_byte_array(const DataValue& data)
{
    Array<std::uint8_t> bytes;
    if (const ByteString& from = *data.value.get_if<ByteString>(); !from.is_null()) {
        const auto span = from.span();
        bytes.resize(span.size());
        std::transform(span.begin(), span.end(), bytes.begin(),
                       [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
    }
    auto converted =
        std::make_unique<DataValue>(Variant{std::move(bytes)}, data.status, data.source_timestamp);
    converted->source_picoseconds = data.source_picoseconds;
    return memory_->converted.emplace_back(std::move(converted)).get();
}

bool WriteJob::start(SourceCallOwner& owner, TimePoint now)
{
    call_.kept_for_sources() = memory_;
    return call_.start(owner, now, [](WritePart&) {});
}

void WriteJob::keep(WriteRequest request, std::vector<std::byte> message)
{
    // Moving the array and the buffer leaves their contents in place.
    memory_->request = std::move(request);
    memory_->message = std::move(message);
}

void WriteJob::encode_results(binary::Writer& writer, const Array<DiagnosticInfo>& infos) const
{
    writer.length(call_.size());
    for (std::size_t i = 0; i < call_.size(); ++i) {
        encode(writer, call_.result(i));
    }
    encode(writer, infos);
}

} // namespace busbar::server::detail
