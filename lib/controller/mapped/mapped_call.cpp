#include <algorithm>
#include <utility>

#include "mapped_operation.hpp"

namespace busbar::controller::detail {

namespace {

using backend::LabelRequest;

/// The Handle's bits are read, then the inputs written, and bit 0 last of all (8.3, Method
/// execution).
class Call final : public MappedOperation {
public:
    explicit Call(server::CallBatch batch) : batch_{std::move(batch)} {}

    std::unique_ptr<LabelRequest> next(MappedContext& context) override;
    void done(MappedContext& context, const LabelRequest& request) override;
    void restart(MappedContext&) override { stage_ = Stage::Read; }
    void fail(MappedContext& context, StatusCode status) override;

private:
    enum class Stage : std::uint8_t { Check, Read, WriteInputs, WriteHandle, Answered };

    void check(MappedContext& context);
    [[nodiscard]] StatusCode check_one(MappedContext& context, const server::CallItem& item) const;
    [[nodiscard]] static Array<StatusCode> check_inputs(MappedContext& context,
                                                        const MappedTable::Method& method,
                                                        const server::CallItem& item);
    [[nodiscard]] std::unique_ptr<LabelRequest> handles(MappedContext& context,
                                                        LabelRequest::Kind kind) const;
    [[nodiscard]] std::unique_ptr<LabelRequest> inputs(MappedContext& context) const;
    void take_handles(MappedContext& context, const LabelRequest& request);
    void refuse(MappedContext& context, std::size_t index, server::CallResult result);
    void finish(MappedContext& context, const server::CallResult& result);

    server::CallBatch batch_;
    Stage stage_{Stage::Check};
    /// The items that are not answered yet.
    std::vector<std::size_t> open_;
};

/// How an input's value suits its labels.
StatusCode to_input_result(StatusCode status)
{
    // Another number of elements than labels (8.1, InputArgumentResultCode).
    return status == status::Bad_WriteNotSupported ? StatusCode{status::Bad_NotSupported} : status;
}

StatusCode encode_input(const MappedContext& context, const MappedTable::Argument& argument,
                        const Variant& value, std::byte* bytes)
{
    return argument.shape == nullptr ? StatusCode{status::Bad_NotSupported}
                                     : to_input_result(context.table.encode(
                                           *argument.shape, argument.range, value, bytes));
}

std::size_t input_count(const MappedTable::Method& method, const server::CallItem& item)
{
    return std::min(method.arguments.size(), item.inputs.size());
}

StatusCode Call::check_one(MappedContext& context, const server::CallItem& item) const
{
    if (context.space != nullptr) {
        const model::NodeIndex object = context.space->find(*item.object_id);
        if (object != model::no_node &&
            context.space->node_class(object) == NodeClass::ObjectType) {
            return status::Bad_NotSupported;
        }
    }
    const auto* const method = context.table.method(item.handle);
    if (method == nullptr || method->handle.count == 0) {
        return status::Bad_NotImplemented;
    }
    if (method->has_outputs) {
        return status::Bad_NotSupported;
    }
    if (method->is_broken) {
        return status::Bad_NoCommunication;
    }
    return method->is_running ? status::Bad_TooManyOperations : status::Good;
}

/// Null if all inputs suit.
Array<StatusCode> Call::check_inputs(MappedContext& context, const MappedTable::Method& method,
                                     const server::CallItem& item)
{
    Array<StatusCode> results;
    std::vector<std::byte> bytes;
    for (std::size_t i = 0; i < input_count(method, item); ++i) {
        const MappedTable::Argument& argument = method.arguments[i];
        if (argument.range.count == 0) {
            continue;
        }
        bytes.resize(argument.range.bytes);
        const StatusCode status = encode_input(context, argument, item.inputs[i], bytes.data());
        if (status.is_bad()) {
            results.resize(item.inputs.size());
            results[i] = status;
        }
    }
    return results;
}

void Call::check(MappedContext& context)
{
    for (std::size_t i = 0; i < batch_.size(); ++i) {
        const server::CallItem& item = batch_.items()[i];
        if (const StatusCode status = check_one(context, item); status.is_bad()) {
            batch_.results()[i] = server::CallResult{status};
            continue;
        }
        auto& method = *context.table.method(item.handle);
        server::CallResult result{status::Bad_InvalidArgument};
        result.input_results = check_inputs(context, method, item);
        if (!result.input_results.empty()) {
            batch_.results()[i] = std::move(result);
            continue;
        }
        method.is_running = true;
        open_.push_back(i);
    }
    stage_ = Stage::Read;
}

std::unique_ptr<LabelRequest> Call::next(MappedContext& context)
{
    if (stage_ == Stage::Check) {
        check(context);
    }
    if (open_.empty() || stage_ == Stage::Answered) {
        finish(context, server::CallResult{});
        return nullptr;
    }
    if (stage_ == Stage::Read) {
        return handles(context, LabelRequest::Kind::Read);
    }
    if (stage_ == Stage::WriteInputs) {
        auto request = inputs(context);
        // Labels may have other types than when they were checked.
        if (request == nullptr) {
            fail(context, status::Bad_NoCommunication);
            return nullptr;
        }
        if (!request->places.empty()) {
            return request;
        }
        stage_ = Stage::WriteHandle;
    }
    auto request = handles(context, LabelRequest::Kind::Write);
    for (const backend::LabelPlace& place : request->places) {
        request->bytes[place.offset] = std::byte{1}; // b1 to b15 are always 0
    }
    return request;
}

std::unique_ptr<LabelRequest> Call::handles(MappedContext& context, LabelRequest::Kind kind) const
{
    auto request = std::make_unique<LabelRequest>();
    request->kind = kind;
    for (const std::size_t i : open_) {
        context.table.add_places(context.table.method(batch_.items()[i].handle)->handle, *request);
    }
    return request;
}

std::unique_ptr<LabelRequest> Call::inputs(MappedContext& context) const
{
    auto request = std::make_unique<LabelRequest>();
    request->kind = LabelRequest::Kind::Write;
    LeafRange all;
    for (const std::size_t i : open_) {
        const server::CallItem& item = batch_.items()[i];
        const auto& method = *context.table.method(item.handle);
        for (std::size_t input = 0; input < input_count(method, item); ++input) {
            const MappedTable::Argument& argument = method.arguments[input];
            all.count += argument.range.count;
            all.words += argument.range.words;
            if (argument.range.count == 0) {
                continue;
            }
            if (!is_within(context.options.limits, all.count, all.words)) {
                return nullptr;
            }
            const std::size_t offset = request->bytes.size();
            context.table.add_places(argument.range, *request);
            if (encode_input(context, argument, item.inputs[input], request->bytes.data() + offset)
                    .is_bad()) {
                return nullptr;
            }
        }
    }
    return request;
}

void Call::done(MappedContext& context, const LabelRequest& request)
{
    switch (stage_) {
    case Stage::Read:
        take_handles(context, request);
        stage_ = Stage::WriteInputs;
        break;
    case Stage::WriteInputs:
        stage_ = Stage::WriteHandle;
        break;
    case Stage::WriteHandle:
        finish(context, server::CallResult{status::Good});
        break;
    case Stage::Check:
    case Stage::Answered:
        break;
    }
}

void Call::take_handles(MappedContext& context, const LabelRequest& request)
{
    std::vector<std::size_t> open = std::exchange(open_, {});
    for (std::size_t i = 0; i < open.size(); ++i) {
        const bool is_busy =
            (request.bytes[request.places[i].offset] & std::byte{1}) != std::byte{0};
        if (is_busy) {
            refuse(context, open[i], server::CallResult{status::Bad_TooManyOperations});
        } else {
            open_.push_back(open[i]);
        }
    }
}

void Call::refuse(MappedContext& context, std::size_t index, server::CallResult result)
{
    context.table.method(batch_.items()[index].handle)->is_running = false;
    batch_.results()[index] = std::move(result);
}

/// The result of those that are open; the others have theirs.
void Call::finish(MappedContext& context, const server::CallResult& result)
{
    for (const std::size_t i : std::exchange(open_, {})) {
        refuse(context, i, result);
    }
    batch_.complete();
    stage_ = Stage::Answered;
}

void Call::fail(MappedContext& context, StatusCode status)
{
    if (stage_ != Stage::Check && open_.size() != batch_.size()) {
        return finish(context, server::CallResult{status});
    }
    for (const std::size_t i : std::exchange(open_, {})) {
        context.table.method(batch_.items()[i].handle)->is_running = false;
    }
    batch_.fail(status);
    stage_ = Stage::Answered;
}

} // namespace

std::unique_ptr<MappedOperation> make_call(server::CallBatch batch)
{
    return std::make_unique<Call>(std::move(batch));
}

} // namespace busbar::controller::detail
