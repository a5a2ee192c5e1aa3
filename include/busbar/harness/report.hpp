#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/harness/text.hpp>

/// Tells a test framework of the worlds of a test; catch.hpp and its siblings use it.
namespace busbar::harness {

/// Returns what to print beside a check that fails: of each world that exists, the seed that
/// repeats the run, and at most so many of the last lines of its log and of the messages on its
/// network. Empty if there is no world. Not while another thread runs one.
[[nodiscard]] BUSBAR_API std::string account_of_worlds(std::size_t lines = 20);

/// Tells the framework that the running test has failed; must not throw.
using FailTest = void (*)(const std::string& why);
/// Sets what is called when a world ends whose faults have never acted, or a scripted peer whose
/// report has never been read, and returns what was; null, as at first: nothing is called. Not
/// beside running tests.
BUSBAR_API FailTest set_fail_test(FailTest fail_test);
/// Lets the running test fail for this reason, to which its framework adds the account of the
/// worlds that exist; nothing if an exception is on its way, or no framework has called
/// set_fail_test(). May be called by destructors.
BUSBAR_API void fail_test(const std::string& why);

/// Returns the value, or throws std::runtime_error with the status: for what a test needs and is
/// not about.
template <typename T>
T need(Result<T> result)
{
    if (!result) {
        // The worlds of the test are gone when its framework sees the exception.
        throw std::runtime_error{"what the test needs has failed: " + text_of(result.error()) +
                                 "\n" + account_of_worlds()};
    }
    if constexpr (!std::is_void_v<T>) {
        return *std::move(result);
    }
}

} // namespace busbar::harness
