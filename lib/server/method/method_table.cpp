#include <busbar/server/method_table.hpp>

#include <busbar/core/detail/guarded.hpp>

#include "call_part.hpp"

namespace busbar::server {

void MethodCall::succeed(Array<Variant> outputs)
{
    CallResult result{status::Good};
    result.outputs = std::move(outputs);
    finish(std::move(result));
}

void MethodCall::fail(StatusCode status, std::string reason)
{
    CallResult result{status};
    result.reason = std::move(reason);
    finish(std::move(result));
}

void MethodCall::refuse(Array<StatusCode> input_results, std::string reason)
{
    CallResult result{status::Bad_InvalidArgument};
    result.input_results = std::move(input_results);
    result.reason = std::move(reason);
    finish(std::move(result));
}

void MethodCall::finish(CallResult result)
{
    if (const auto batch = std::move(batch_)) {
        const StatusCode status = result.status;
        batch->results()[index_] = std::move(result);
        if (detail::ResultMark* const mark = batch->items()[index_].mark) {
            mark->status = status;
            mark->is_set = true;
        }
    }
}

std::uint64_t MethodTable::add(Function function)
{
    if (!free_.empty()) {
        const std::uint64_t handle = free_.back();
        functions_[static_cast<std::size_t>(handle)] = std::move(function);
        free_.pop_back();
        return handle;
    }
    functions_.push_back(std::move(function));
    return functions_.size() - 1;
}

void MethodTable::remove(std::uint64_t handle) noexcept
{
    if (handle < functions_.size() && functions_[static_cast<std::size_t>(handle)]) {
        functions_[static_cast<std::size_t>(handle)] = nullptr;
        // Without memory the place stays empty, which costs a few bytes.
        busbar::detail::attempt([&] { free_.push_back(handle); });
    }
}

void MethodTable::call(CallBatch batch)
{
    const auto shared = std::make_shared<CallBatch>(std::move(batch));
    for (std::size_t i = 0; i < shared->size(); ++i) {
        const std::uint64_t handle = shared->items()[i].handle;
        MethodCall call{shared, i};
        if (handle < functions_.size() && functions_[static_cast<std::size_t>(handle)]) {
            // A throwing function leaves its call unanswered, and does not affect the others of the
            // batch.
            busbar::detail::guarded(shared->log(), "MethodTable::Function", [&] {
                functions_[static_cast<std::size_t>(handle)](std::move(call));
            });
        } else {
            call.fail(status::Bad_NotImplemented);
        }
    }
}

} // namespace busbar::server
