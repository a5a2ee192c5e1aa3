#include <algorithm>
#include <utility>

#include "mapped_operation.hpp"

namespace busbar::controller::detail {

namespace {

using backend::LabelRequest;

/// Calls Methods: reads the bits of the Handles, writes the inputs, and sets bit 0 last (8.3,
/// Method execution). A Done is set to 0 before bit 0 is set, and then read once per scan, together
/// with the outputs so that all are from the same moment, until it is not 0.
class Call final : public MappedOperation {
public:
    explicit Call(server::CallBatch batch) : batch_{std::move(batch)} {}

    std::unique_ptr<LabelRequest> next(MappedContext& context) override;
    void done(MappedContext& context, const LabelRequest& request) override;
    /// A started Method is not started again.
    void restart(MappedContext&) override
    {
        stage_ = stage_ == Stage::Wait ? Stage::Wait : Stage::Read;
    }
    void fail(MappedContext& context, StatusCode status) override;

private:
    enum class Stage : std::uint8_t { Check, Read, WriteInputs, WriteHandle, Wait, Answered };

    void check(MappedContext& context);
    [[nodiscard]] StatusCode check_one(MappedContext& context, const server::CallItem& item) const;
    [[nodiscard]] static Array<StatusCode> check_inputs(MappedContext& context,
                                                        const MappedTable::Method& method,
                                                        const server::CallItem& item);
    [[nodiscard]] std::unique_ptr<LabelRequest> handles(MappedContext& context,
                                                        LabelRequest::Kind kind) const;
    [[nodiscard]] std::unique_ptr<LabelRequest> inputs(MappedContext& context) const;
    void take_handles(MappedContext& context, const LabelRequest& request);
    void begin_waiting(MappedContext& context, DateTime time);
    [[nodiscard]] std::unique_ptr<LabelRequest> results(MappedContext& context) const;
    void take_results(MappedContext& context, const LabelRequest& request);
    [[nodiscard]] static server::CallResult
    result_of(MappedContext& context, const MappedTable::Method& method, const std::byte* bytes);
    [[nodiscard]] bool is_too_late(const MappedOptions& options, DateTime time);
    void answer(MappedContext& context, std::size_t index, server::CallResult result);
    void finish(MappedContext& context, const server::CallResult& result);

    server::CallBatch batch_;
    Stage stage_{Stage::Check};
    /// Indices of the items that are not answered yet.
    std::vector<std::size_t> open_;
    /// When the handles were set, and how often the Dones were read since.
    DateTime begun_{};
    std::size_t looks_{0};
};

/// Translates the status of an input whose value does not suit its labels.
StatusCode to_input_result(StatusCode status)
{
    // The number of elements differs from that of the labels (8.1, InputArgumentResultCode).
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

/// Checks all inputs; null if all suit.
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
    if (stage_ == Stage::Wait) {
        return results(context);
    }
    if (stage_ == Stage::WriteInputs) {
        auto request = inputs(context);
        // The types of labels may have changed since they were checked.
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
        context.table.add_places(method.done, *request); // the place keeps its 0
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
        begin_waiting(context, request.time);
        break;
    case Stage::Wait:
        take_results(context, request);
        break;
    case Stage::Check:
    case Stage::Answered:
        break;
    }
}

/// Answers Methods without a Done and starts to wait for the others.
void Call::begin_waiting(MappedContext& context, DateTime time)
{
    for (const std::size_t i : std::exchange(open_, {})) {
        if (context.table.method(batch_.items()[i].handle)->done.count == 0) {
            answer(context, i, server::CallResult{status::Good});
        } else {
            open_.push_back(i);
        }
    }
    begun_ = time;
    stage_ = Stage::Wait;
}

/// Makes the request that reads Done and the outputs of all waiting Methods.
std::unique_ptr<LabelRequest> Call::results(MappedContext& context) const
{
    auto request = std::make_unique<LabelRequest>();
    request->kind = LabelRequest::Kind::Read;
    for (const std::size_t i : open_) {
        const auto& method = *context.table.method(batch_.items()[i].handle);
        context.table.add_places(method.done, *request);
        for (const MappedTable::Argument& output : method.outputs) {
            context.table.add_places(output.range, *request);
        }
    }
    return request;
}

server::CallResult Call::result_of(MappedContext& context, const MappedTable::Method& method,
                                   const std::byte* bytes)
{
    server::CallResult result{status::Good};
    for (const MappedTable::Argument& output : method.outputs) {
        const MappedLeaf* culprit = nullptr;
        auto value = context.table.decode(*output.shape, output.range, bytes, nullptr, &culprit);
        if (!value) {
            if (culprit != nullptr && context.observer != nullptr) {
                context.observer->error({MappedErrorCode::OutOfRange,
                                         context.table.name_of(*culprit),
                                         &context.table.node_of(*culprit)});
            }
            return server::CallResult{status::Bad_NoCommunication};
        }
        result.outputs.push_back(*std::move(value));
        bytes += output.range.bytes;
    }
    return result;
}

bool Call::is_too_late(const MappedOptions& options, DateTime time)
{
    // Give up also if the clock stands still or is set back.
    constexpr std::size_t most_looks = 100'000;
    const std::int64_t limit = options.call_limit.count() * (DateTime::ticks_per_second / 1'000);
    return ++looks_ > most_looks || time < begun_ || time.ticks - begun_.ticks > limit;
}

void Call::take_results(MappedContext& context, const LabelRequest& request)
{
    const bool is_late = is_too_late(context.options, request.time);
    const std::byte* bytes = request.bytes.data();
    for (const std::size_t i : std::exchange(open_, {})) {
        const auto& method = *context.table.method(batch_.items()[i].handle);
        const bool is_done = std::any_of(bytes, bytes + method.done.bytes,
                                         [](std::byte byte) { return byte != std::byte{0}; });
        bytes += method.done.bytes;
        if (is_done) {
            answer(context, i, result_of(context, method, bytes));
        } else if (is_late) {
            answer(context, i, server::CallResult{status::Bad_Timeout});
        } else {
            open_.push_back(i);
        }
        for (const MappedTable::Argument& output : method.outputs) {
            bytes += output.range.bytes;
        }
    }
    waits_a_turn = !open_.empty();
}

void Call::take_handles(MappedContext& context, const LabelRequest& request)
{
    std::vector<std::size_t> open = std::exchange(open_, {});
    for (std::size_t i = 0; i < open.size(); ++i) {
        const bool is_busy =
            (request.bytes[request.places[i].offset] & std::byte{1}) != std::byte{0};
        if (is_busy) {
            answer(context, open[i], server::CallResult{status::Bad_TooManyOperations});
        } else {
            open_.push_back(open[i]);
        }
    }
}

void Call::answer(MappedContext& context, std::size_t index, server::CallResult result)
{
    context.table.method(batch_.items()[index].handle)->is_running = false;
    batch_.results()[index] = std::move(result);
}

/// Answers all open items with the same result.
void Call::finish(MappedContext& context, const server::CallResult& result)
{
    for (const std::size_t i : std::exchange(open_, {})) {
        answer(context, i, result);
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
