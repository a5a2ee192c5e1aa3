#pragma once

// For tests with doctest; the library itself does not need it. A test that fails shows the account
// of its worlds (report.hpp): seed, log, last messages.

#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <busbar/harness/bench.hpp>
#include <busbar/harness/report.hpp>
#include <busbar/harness/text.hpp>

namespace doctest {

template <>
struct StringMaker<busbar::StatusCode> {
    static String convert(const busbar::StatusCode& code)
    {
        return busbar::harness::text_of(code).c_str();
    }
};

template <>
struct StringMaker<busbar::NodeId> {
    static String convert(const busbar::NodeId& id) { return busbar::to_string(id).c_str(); }
};

template <>
struct StringMaker<busbar::Variant> {
    static String convert(const busbar::Variant& value)
    {
        return busbar::harness::text_of(value).c_str();
    }
};

template <>
struct StringMaker<busbar::DataValue> {
    static String convert(const busbar::DataValue& value)
    {
        return busbar::harness::text_of(value).c_str();
    }
};

template <typename T>
struct StringMaker<busbar::Result<T>> {
    static String convert(const busbar::Result<T>& result)
    {
        return result ? "a value" : busbar::harness::text_of(result.error()).c_str();
    }
};

} // namespace doctest

namespace busbar::harness {

namespace detail {

/// Prints the account of the test's worlds below a check that fails.
class DoctestListener final : public doctest::IReporter {
public:
    explicit DoctestListener(const doctest::ContextOptions& options) : out_{options.cout} {}

    void report_query(const doctest::QueryData&) override {}
    void test_run_start() override {}
    void test_run_end(const doctest::TestRunStats&) override {}
    void test_case_start(const doctest::TestCaseData&) override {}
    void test_case_reenter(const doctest::TestCaseData&) override {}
    void test_case_end(const doctest::CurrentTestCaseStats&) override {}
    void test_case_exception(const doctest::TestCaseException&) override {}
    void subcase_start(const doctest::SubcaseSignature&) override {}
    void subcase_end() override {}
    void log_assert(const doctest::AssertData& data) override
    {
        if (data.m_failed) {
            *out_ << account_of_worlds();
        }
    }
    void log_message(const doctest::MessageData&) override {}
    void test_case_skipped(const doctest::TestCaseData&) override {}

private:
    std::ostream* out_;
};
inline const bool has_listener = [] {
    set_fail_test([](const std::string& why) { FAIL_CHECK(why); });
    return doctest::registerReporter<DoctestListener>("busbar", 1, false) == 0;
}();

} // namespace detail

/// A value that is Good, whatever its timestamps: CHECK(read(node) == holds(42)).
struct Held {
    /// The value that is wanted.
    Variant value;

    friend bool operator==(const DataValue& found, const Held& wanted)
    {
        return found.status.is_good() && found.value == wanted.value;
    }
};
/// Creates a Held.
template <typename T>
[[nodiscard]] Held holds(T value)
{
    return {Variant{std::move(value)}};
}

} // namespace busbar::harness

namespace doctest {

template <>
struct StringMaker<busbar::harness::Held> {
    static String convert(const busbar::harness::Held& held)
    {
        return ("holds " + busbar::harness::text_of(held.value)).c_str();
    }
};

} // namespace doctest
