#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/core/expected.hpp>

namespace expected_test {

using namespace busbar;

namespace {

using Text = Expected<std::string, int>;
using Number = Expected<int, int>;
using Owner = Expected<std::unique_ptr<int>, std::string>;

static_assert(std::is_trivially_copyable_v<Number>);
static_assert(std::is_copy_constructible_v<Text> && std::is_copy_assignable_v<Text>);
static_assert(!std::is_copy_constructible_v<Owner> && !std::is_copy_assignable_v<Owner>);
static_assert(std::is_nothrow_move_constructible_v<Owner>);
static_assert(!std::is_convertible_v<int, Expected<std::vector<int>, int>>); // vector's is explicit
static_assert(std::is_convertible_v<const char*, Text>);

const std::string long_text(100, 'x');

} // namespace

TEST_CASE("expected: a value or an error")
{
    const Text value{long_text};
    REQUIRE(value);
    CHECK(value.has_value());
    CHECK(*value == long_text);
    CHECK(value->size() == 100);
    CHECK(value == long_text);
    const Text error = Unexpected{7};
    REQUIRE_FALSE(error);
    CHECK(error.error() == 7);
    CHECK_FALSE(error == value);
    CHECK(error == Text{Unexpected{7}});
    CHECK_FALSE(error == Text{Unexpected{8}});
    CHECK(Text{}.value().empty());
}

TEST_CASE("expected: copies and moves, also from one kind to the other")
{
    const Text values[]{Text{long_text}, Text{"other" + long_text}, Text{Unexpected{1}},
                        Text{Unexpected{2}}};
    for (const Text& from : values) {
        for (const Text& to : values) {
            Text copied = to;
            copied = from;
            CHECK(copied == from);
            Text moved = to;
            moved = std::move(copied);
            CHECK(moved == from);
            const Text made{std::move(moved)};
            CHECK(made == from);
        }
    }
    Text self{long_text};
    Text& same = self;
    self = same;
    CHECK(self == long_text);
    self = std::move(same);
    CHECK(self == long_text);
}

TEST_CASE("expected: what can only be moved")
{
    Owner owner{std::make_unique<int>(3)};
    Owner other{Unexpected<std::string>{long_text}};
    std::swap(owner, other);
    CHECK(owner.error() == long_text);
    REQUIRE(other);
    const std::unique_ptr<int> taken = *std::move(other);
    CHECK(*taken == 3);
}

TEST_CASE("expected: its value or another one, and what is asked for in vain")
{
    CHECK(Number{3}.value_or(4) == 3);
    CHECK(Number{Unexpected{3}}.value_or(4) == 4);
    const Text error{Unexpected{7}};
    CHECK(error.value_or("none") == "none");
    CHECK(Text{long_text}.value_or("none") == long_text);
    CHECK_THROWS_AS(error.value(), BadExpectedAccess);
    CHECK_THROWS_WITH(Number{Unexpected{1}}.value(), Catch::Contains("error"));
}

TEST_CASE("expected: what follows is done with a value only")
{
    const auto half = [](int number) -> Number {
        return number % 2 == 0 ? Number{number / 2} : Number{Unexpected{number}};
    };
    CHECK(Number{12}.and_then(half).and_then(half) == 3);
    const Number odd = Number{6}.and_then(half).and_then(half).and_then(half);
    CHECK(odd.error() == 3);
    CHECK(Number{6}.transform([](int number) { return std::to_string(number); }) == "6");
    CHECK(odd.transform([](int number) { return number + 1; }).error() == 3);
    CHECK(Number{odd}.transform_error([](int error) { return error * 2; }).error() == 6);
    CHECK(Number{2}.transform_error([](int) { return std::string{"bad"}; }).value() == 2);
    Owner owner{std::make_unique<int>(3)};
    CHECK(std::move(owner).transform([](std::unique_ptr<int> taken) { return *taken; }).value() ==
          3);
}

TEST_CASE("expected: of nothing but success")
{
    using Done = Expected<void, std::string>;
    int count = 0;
    const auto step = [&]() -> Done {
        ++count;
        return {};
    };
    CHECK(Done{}.and_then(step).and_then(step).has_value());
    CHECK(count == 2);
    const Done failed =
        Done{}.and_then(step).and_then([]() -> Done { return Unexpected{long_text}; });
    CHECK(failed.error() == long_text);
    CHECK(failed.and_then(step).error() == long_text);
    CHECK(count == 3);
    CHECK(Done{}.transform([] { return 5; }).value() == 5);
    CHECK(Done{}.transform([&] { ++count; }).has_value());
    CHECK(count == 4);
}

} // namespace expected_test
