#pragma once

// For tests with Catch2, version 2 or 3; the library itself does not need it. A test whose Catch2
// header is elsewhere includes that before this one. With version 2 the file that has
// CATCH_CONFIG_MAIN or CATCH_CONFIG_RUNNER includes this header, too: what makes a failing check
// show the account of the test's worlds (report.hpp) is compiled there.

#include <string>
#include <type_traits>
#include <utility>

#ifndef CATCH_VERSION_MAJOR
#if __has_include(<catch2/catch_test_macros.hpp>)
#include <catch2/catch_message.hpp>
#include <catch2/catch_test_macros.hpp>
#include <catch2/catch_tostring.hpp>
#include <catch2/catch_version_macros.hpp>
#include <catch2/matchers/catch_matchers.hpp>
#include <catch2/reporters/catch_reporter_event_listener.hpp>
#include <catch2/reporters/catch_reporter_registrars.hpp>
#else
#include <catch2/catch.hpp>
#endif
#endif

#include <busbar/harness/bench.hpp>
#include <busbar/harness/report.hpp>
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

namespace detail {

#if CATCH_VERSION_MAJOR >= 3
template <typename T>
using MatcherBase = Catch::Matchers::MatcherBase<T>;
using ListenerBase = Catch::EventListenerBase;
#else
template <typename T>
using MatcherBase = Catch::MatcherBase<T>;
#ifdef CATCH_CONFIG_EXTERNAL_INTERFACES
using ListenerBase = Catch::TestEventListenerBase;
#endif
#endif

/// Whether CatchListener is there; else BenchFixture shows the seed.
inline bool has_listener = false;

#if CATCH_VERSION_MAJOR >= 3 || defined(CATCH_CONFIG_EXTERNAL_INTERFACES)
/// Adds the account of the test's worlds to a check that fails.
class CatchListener final : public ListenerBase {
public:
    using ListenerBase::assertionEnded;
    using ListenerBase::ListenerBase;

    auto assertionEnded(const Catch::AssertionStats& stats)
        -> decltype(std::declval<ListenerBase&>().assertionEnded(stats)) override
    {
        std::string account = stats.assertionResult.isOk() ? std::string{} : account_of_worlds();
        if (!account.empty()) {
            Catch::MessageInfo message{"INFO", stats.assertionResult.getSourceInfo(),
                                       Catch::ResultWas::Info};
            message.message = std::move(account);
            // A listener gets the object before the reporter does, and this is what makes the
            // account a part of each reporter's text. It is a temporary that is not constant.
            const_cast<Catch::AssertionStats&>(stats).infoMessages.push_back(std::move(message));
        }
        return decltype(std::declval<ListenerBase&>().assertionEnded(stats))();
    }
};
/// Registers the listener, by a name where the version wants one.
template <typename Registrar>
Registrar register_listener()
{
    has_listener = true;
    if constexpr (std::is_default_constructible_v<Registrar>) {
        return Registrar();
    } else {
        return Registrar("busbar");
    }
}
inline const auto account_listener = register_listener<Catch::ListenerRegistrar<CatchListener>>();
#endif

inline const bool has_fail_test =
    (set_fail_test([](const std::string& why) { FAIL_CHECK(why); }), true);

} // namespace detail

/// Matches a DataValue with this value and status Good, whatever its timestamps:
/// CHECK_THAT(read(node), holds(42)).
class HoldsMatcher final : public detail::MatcherBase<DataValue> {
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
class HasStatusMatcher final : public detail::MatcherBase<DataValue> {
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
class SucceedsMatcher final : public detail::MatcherBase<Result<T>> {
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

/// A Bench as the fixture of a TEST_CASE_METHOD, or as its base.
class BenchFixture : public Bench {
public:
    explicit BenchFixture(BenchOptions options = {}) : Bench{std::move(options)}
    {
        if (!detail::has_listener) {
            UNSCOPED_INFO("repeated by BUSBAR_SEED=" << world().seed());
        }
    }
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
