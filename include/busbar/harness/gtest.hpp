#pragma once

// For tests with GoogleTest; the library itself does not need it. A test that fails shows the
// account of its worlds (report.hpp): seed, log, last messages.

#include <ostream>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include <busbar/harness/bench.hpp>
#include <busbar/harness/report.hpp>
#include <busbar/harness/text.hpp>

// GoogleTest finds these by the types' namespace.
namespace busbar {

inline void PrintTo(const StatusCode& code, std::ostream* out)
{
    *out << harness::text_of(code);
}
inline void PrintTo(const NodeId& id, std::ostream* out)
{
    *out << to_string(id);
}
inline void PrintTo(const Variant& value, std::ostream* out)
{
    *out << harness::text_of(value);
}
inline void PrintTo(const DataValue& value, std::ostream* out)
{
    *out << harness::text_of(value);
}

} // namespace busbar

namespace busbar::harness {

namespace detail {

/// Prints the account of the test's worlds below a check that fails.
class GoogleTestListener final : public ::testing::EmptyTestEventListener {
public:
    void OnTestPartResult(const ::testing::TestPartResult& result) override
    {
        if (result.failed()) {
            std::printf("%s", account_of_worlds().c_str());
        }
    }
};
inline const bool has_listener = [] {
    ::testing::UnitTest::GetInstance()->listeners().Append(new GoogleTestListener); // which owns it
    set_fail_test([](const std::string& why) { ADD_FAILURE() << why; });
    return true;
}();

} // namespace detail

/// EXPECT_TRUE(holds(read(node), 42)): this value with status Good, whatever its timestamps.
template <typename T>
[[nodiscard]] ::testing::AssertionResult holds(const DataValue& found, T wanted)
{
    const Variant value{std::move(wanted)};
    if (found.status.is_good() && found.value == value) {
        return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << text_of(found) << " does not hold " << text_of(value);
}

/// EXPECT_TRUE(has_status(read(node), status::Bad_Timeout)): compared without info bits.
[[nodiscard]] inline ::testing::AssertionResult has_status(const DataValue& found,
                                                           StatusCode wanted)
{
    if (found.status.code() == wanted.code()) {
        return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << text_of(found) << " is not " << text_of(wanted);
}

/// EXPECT_TRUE(succeeds(connect())): shows the status if not.
template <typename T>
[[nodiscard]] ::testing::AssertionResult succeeds(const Result<T>& result)
{
    if (result) {
        return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << text_of(result.error());
}

/// A Bench as the fixture of a TEST_F, or as its base.
class BenchTest : public ::testing::Test, public Bench {
public:
    /// Creates the bench.
    explicit BenchTest(BenchOptions options = {}) : Bench{std::move(options)} {}
};

} // namespace busbar::harness
