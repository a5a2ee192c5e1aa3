#pragma once

#include <memory>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::client::detail {

/// What a request's handler is for an operation in several steps: `step` gets the operation and the
/// answer. A step that finds no memory is the last one: no_memory() of the operation ends it, so
/// that its own handler is called all the same.
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
