#include "guard.hpp"

#include <algorithm>
#include <cstdio>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/text.hpp>

namespace busbar::c {

void FailureText::set(std::string_view text) noexcept
{
    const std::size_t size = std::min(text.size(), text_.size() - 1);
    std::copy_n(text.begin(), size, text_.begin());
    text_[size] = '\0';
    is_set_ = true;
}

busbar_status run_guarded(FailureText* failure, FunctionRef<StatusCode()> body) noexcept
{
    const bool was_set = failure != nullptr && failure->begin();
    busbar::detail::ThrownText what;
    StatusCode result;
    const StatusCode thrown = busbar::detail::caught(what, [&] { result = body(); });
    if (thrown.is_bad()) {
        result = thrown;
    }
    if (failure != nullptr && result.is_bad() && !failure->is_set()) {
        failure->set(thrown.is_bad() ? what.view() : name(result));
    }
    if (failure != nullptr) {
        failure->end(was_set);
    }
    return result.value();
}

StatusCode failed(FailureText& failure, StatusCode status, std::string_view text)
{
    failure.set(text);
    return status;
}

StatusCode misconfigured(FailureText& failure, const char* list, std::size_t index,
                         const char* text, StatusCode status) noexcept
{
    std::array<char, 256> line;
    std::snprintf(line.data(), line.size(), "%s[%zu]: %s", list, index, text);
    failure.set(line.data());
    return status;
}

StatusCode misconfigured(FailureText& failure, const char* where, const char* text,
                         StatusCode status) noexcept
{
    std::array<char, 256> line;
    std::snprintf(line.data(), line.size(), "%s: %s", where, text);
    failure.set(line.data());
    return status;
}

StatusCode failed(FailureText& failure, const Problem& problem)
{
    return failed(failure, problem.status, text(problem));
}

} // namespace busbar::c
