#pragma once

#include <memory>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::client::detail {

/// Returns the handler of a request in an operation of several steps: `step` gets the operation and
/// the answer. A step that runs out of memory is the last one: no_memory() ends the operation, so
/// that its own handler is called nevertheless.
template <typename Operation, typename Step>
auto step_of(std::shared_ptr<Operation> operation, Step step)
{
    return [operation = std::move(operation), step = std::move(step)](auto&&... answer) {
        busbar::detail::Undo undo{[&] { operation->no_memory(); }};
        step(*operation, std::forward<decltype(answer)>(answer)...);
        undo.keep();
    };
}

} // namespace busbar::client::detail
