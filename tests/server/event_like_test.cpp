#include <catch2/catch.hpp>

#include <random>
#include <string>

#include "server/event/filter_operators.hpp"

namespace busbar::server::detail::event_like_test {

namespace {

std::optional<bool> like(std::string_view text, std::string_view pattern)
{
    std::size_t steps = 10'000;
    return is_like(text, pattern, steps);
}

} // namespace

TEST_CASE("Like patterns")
{
    struct Row {
        std::string_view text;
        std::string_view pattern;
        bool result;
    };
    const Row rows[] = {
        // Those of Part 4, 7.7.3, Wildcard characters.
        {"main", "main%", true},
        {"main valve", "main%", true},
        {"the main", "main%", false},
        {"the end", "%en%", true},
        {"entry", "%en%", true},
        {"Mi_n", "Mi_n", true},
        {"Main", "Mi_n", false},
        {"500", "5_0", true},
        {"abc1", "abc[13-68]", true},
        {"abc3", "abc[13-68]", true},
        {"abc5", "abc[13-68]", true},
        {"abc8", "abc[13-68]", true},
        {"abc2", "abc[13-68]", false},
        {"abc68", "abc[13-68]", false},
        {"xyzc", "xyz[c-f]", true},
        {"xyzg", "xyz[c-f]", false},
        {"ABC1", "ABC[^13-5]", false},
        {"ABC4", "ABC[^13-5]", false},
        {"ABC2", "ABC[^13-5]", true},
        {"xyzd", "xyz[^dgh]", false},
        {"xyzf", "xyz[^dgh]", true},
        {"\\", "\\\\", true},
        {"%", "\\%", true},
        {"5", "\\%", false},
        {"_", "\\_", true},
        {"a", "\\_", false},
        // Edges.
        {"", "", true},
        {"", "%", true},
        {"", "%%", true},
        {"", "_", false},
        {"a", "", false},
        {"aXbXc", "a%X%c", true},
        {"aab", "%ab", true},
        {"ababac", "%aba_", true},
        {"a", "[]", false},
        {"a", "[^]", true},
        {"]", "[\\]]", true},
        {"-", "[a-]", true},
        {"-", "[-a]", true},
        {"b", "[a-]", false},
        {"^", "[a^]", true},
        {"a", "[a", false},
        {"a", "[a-", false},
        {"[a", "[a", false},
        {"a", "a\\", false},
        {"a\\", "a\\", false},
        {"b", "[c-a]", false},
        {"\u00E9", "_", true},
        {"\u00E9t\u00E9", "\u00E9_\u00E9", true},
        {"\u00E9", "[\u00E0-\u00EF]", true},
        {"\U0001F600!", "_!", true},
        {"\xFF", "_", true},
        {"\xC3", "_", true},
        {"\xC3", "\xC3", true},
        {"\xE0\x80", "__", true},
    };
    for (const Row& row : rows) {
        INFO('"' << row.text << "\" like \"" << row.pattern << '"');
        CHECK(like(row.text, row.pattern) == row.result);
    }
}

TEST_CASE("Like gives up on a pattern that costs too much")
{
    const std::string text(4'000, 'a');
    std::string pattern = "%";
    for (int i = 0; i < 1'000; ++i) {
        pattern += "a";
    }
    std::size_t steps = 100'000;
    CHECK(is_like(text, pattern + "b", steps) == std::nullopt);
    CHECK(steps == 0);
    steps = 100'000;
    CHECK(is_like(text, "%a%a%a%a%a%a%a%a%a%a", steps) == true);
    CHECK(steps > 90'000);
    // A list costs what it is long.
    steps = 1'000;
    CHECK(is_like(std::string(100, 'a'), "%[" + std::string(500, 'b') + "]", steps) ==
          std::nullopt);
}

TEST_CASE("Like finds what a plain search finds")
{
    // Against the definition, by trying all lengths that a '%' may have.
    struct Plain {
        static bool like(std::string_view text, std::string_view pattern)
        {
            if (pattern.empty()) {
                return text.empty();
            }
            if (pattern.front() == '%') {
                return like(text, pattern.substr(1)) ||
                       (!text.empty() && like(text.substr(1), pattern));
            }
            return !text.empty() && (pattern.front() == '_' || pattern.front() == text.front()) &&
                   like(text.substr(1), pattern.substr(1));
        }
    };
    std::mt19937 random{7};
    for (int i = 0; i < 20'000; ++i) {
        std::string text(random() % 8, 'a');
        std::string pattern(random() % 6, 'a');
        for (char& c : text) {
            c = "ab"[random() % 2];
        }
        for (char& c : pattern) {
            c = "ab%_"[random() % 4];
        }
        INFO('"' << text << "\" like \"" << pattern << '"');
        REQUIRE(like(text, pattern) == Plain::like(text, pattern));
    }
}

} // namespace busbar::server::detail::event_like_test
