#pragma once

// For tests with Catch2, version 2; the library itself does not need it. A test whose Catch2 header
// is elsewhere includes that before this one.

#include <string>
#include <type_traits>
#include <utility>

#ifndef CATCH_VERSION_MAJOR
#include <catch2/catch.hpp>
#endif

#include <busbar/harness/bench.hpp>
#include <busbar/harness/text.hpp>

namespace Catch {

template <>
struct StringMaker<busbar::StatusCode> {
    static std::string convert(busbar::StatusCode code) { return busbar::harness::text_of(code); }
};

template <>
struct StringMaker<busbar::NodeId> {
    static std::string convert(const busbar::NodeId& id) { return busbar::to_string(id); }
};

template <>
struct StringMaker<busbar::Variant> {
    static std::string convert(const busbar::Variant& value)
    {
        return busbar::harness::text_of(value);
    }
};

template <>
struct StringMaker<busbar::DataValue> {
    static std::string convert(const busbar::DataValue& value)
    {
        return busbar::harness::text_of(value);
    }
};

} // namespace Catch

namespace busbar::harness {

/// Matches a DataValue with this value and status Good, whatever its timestamps:
/// CHECK_THAT(read(node), holds(42)).
class HoldsMatcher final : public Catch::MatcherBase<DataValue> {
public:
    explicit HoldsMatcher(Variant value) : value_{std::move(value)} {}
    [[nodiscard]] bool match(const DataValue& value) const override
    {
        return value.status.is_good() && value.value == value_;
    }
    [[nodiscard]] std::string describe() const override { return "holds " + text_of(value_); }

private:
    Variant value_;
};
/// Creates a HoldsMatcher.
template <typename T>
[[nodiscard]] HoldsMatcher holds(T value)
{
    return HoldsMatcher{Variant{std::move(value)}};
}

/// Matches a DataValue with this status, compared without info bits.
class HasStatusMatcher final : public Catch::MatcherBase<DataValue> {
public:
    explicit HasStatusMatcher(StatusCode status) : status_{status} {}
    [[nodiscard]] bool match(const DataValue& value) const override
    {
        return value.status.code() == status_.code();
    }
    [[nodiscard]] std::string describe() const override { return "has " + text_of(status_); }

private:
    StatusCode status_;
};
/// Creates a HasStatusMatcher.
[[nodiscard]] inline HasStatusMatcher has_status(StatusCode status)
{
    return HasStatusMatcher{status};
}

/// Matches a Result that has a value: CHECK_THAT(bench.connect(), succeeds<void>()) shows the
/// status if not.
template <typename T>
class SucceedsMatcher final : public Catch::MatcherBase<Result<T>> {
public:
    [[nodiscard]] bool match(const Result<T>& result) const override { return result.has_value(); }
    [[nodiscard]] std::string describe() const override { return "is a value"; }
};
/// Creates a SucceedsMatcher.
template <typename T>
[[nodiscard]] SucceedsMatcher<T> succeeds()
{
    return {};
}

/// A Bench as the fixture of a TEST_CASE_METHOD, or as its base: a check that fails shows the seed
/// that replays the run.
class BenchFixture : public Bench {
public:
    explicit BenchFixture(BenchOptions options = {})
        : Bench{std::move(options)}, seed_{Catch::MessageBuilder{Catch::StringRef{"INFO", 4},
                                                                 CATCH_INTERNAL_LINEINFO,
                                                                 Catch::ResultWas::Info}
                                           << "replayed by BUSBAR_SEED=" << world().seed()}
    {
    }

private:
    Catch::ScopedMessage seed_;
};

} // namespace busbar::harness

namespace Catch {

template <typename T>
struct StringMaker<busbar::Result<T>> {
    static std::string convert(const busbar::Result<T>& result)
    {
        if (!result) {
            return busbar::harness::text_of(result.error());
        }
        if constexpr (std::is_void_v<T>) {
            return "a value";
        } else {
            return StringMaker<T>::convert(*result);
        }
    }
};

} // namespace Catch
