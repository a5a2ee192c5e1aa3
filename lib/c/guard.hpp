#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>

#include <busbar/busbar.h>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/status_code.hpp>

namespace busbar::c {

/// The text of a handle's last failure. It has room of its own, since memory may be what is
/// missing.
class FailureText {
public:
    /// Keeps as much of the text as fits.
    void set(std::string_view text) noexcept;
    [[nodiscard]] const char* c_str() const noexcept { return text_.data(); }
    /// Begins a function: a failure without a text of its own gets the status's name. Returns
    /// whether one that it is called in, by a callback, has set its text, for end().
    [[nodiscard]] bool begin() noexcept { return std::exchange(is_set_, false); }
    /// Goes back to the function around it.
    void end(bool was_set) noexcept { is_set_ = was_set; }
    [[nodiscard]] bool is_set() const noexcept { return is_set_; }

private:
    std::array<char, 256> text_{};
    bool is_set_{false};
};

/// Runs the body of a function of the C interface, which no exception leaves: a failed allocation
/// is Bad_OutOfMemory, everything else Bad_InternalError. Keeps the text of a failure in `failure`,
/// which may be null.
[[nodiscard]] busbar_status run_guarded(FailureText* failure,
                                        FunctionRef<StatusCode()> body) noexcept;

/// Keeps what is wrong, and returns the status.
StatusCode failed(FailureText& failure, StatusCode status, std::string_view text);
StatusCode failed(FailureText& failure, const Problem& problem);
/// Keeps what is wrong with a configuration: "users[3]: has no name". Returns
/// Bad_ConfigurationError, or `status`.
StatusCode misconfigured(FailureText& failure, const char* list, std::size_t index,
                         const char* text,
                         StatusCode status = status::Bad_ConfigurationError) noexcept;
StatusCode misconfigured(FailureText& failure, const char* where, const char* text,
                         StatusCode status = status::Bad_ConfigurationError) noexcept;

/// Returns the text, or `otherwise` for null.
[[nodiscard]] inline std::string_view text_or(const char* text, std::string_view otherwise)
{
    return text != nullptr ? std::string_view{text} : otherwise;
}

/// Returns the bytes; none for null.
[[nodiscard]] inline std::span<const std::byte> bytes_of(const void* data, std::size_t size)
{
    return {static_cast<const std::byte*>(data), data != nullptr ? size : 0};
}

/// True for `count` elements that are there.
[[nodiscard]] inline bool has_all(const void* elements, std::size_t count)
{
    return elements != nullptr || count == 0;
}

/// The most elements that one function takes.
inline constexpr std::size_t max_elements = 1'000'000;

} // namespace busbar::c
