#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "server/users/stand_in.hpp"

namespace stand_in_test {

using namespace busbar;
using server::detail::stand_in_for;

namespace {

using Hashes = std::vector<std::string_view>;

/// That of each of 300 names.
std::vector<std::string_view> stand_ins(const Hashes& hashes)
{
    std::vector<std::string_view> found;
    for (int i = 0; i < 300; ++i) {
        found.push_back(hashes.at(stand_in_for("stranger" + std::to_string(i), hashes)));
    }
    return found;
}

} // namespace

TEST_CASE("a stranger's name has one stand-in, in whatever order the users are")
{
    const auto found = stand_ins({"one", "two", "three"});
    CHECK(found == stand_ins({"one", "two", "three"}));
    CHECK(found == stand_ins({"three", "one", "two"}));
    CHECK(found != stand_ins({"1", "2", "3"}));
}

TEST_CASE("each user is the stand-in of as many names")
{
    const auto found = stand_ins({"one", "two", "three"});
    for (const std::string_view hash : {"one", "two", "three"}) {
        INFO(hash);
        const auto count = std::count(found.begin(), found.end(), hash);
        CHECK(count > 70);
        CHECK(count < 130);
    }
    CHECK(stand_in_for("", Hashes{"only"}) == 0);
    CHECK(stand_in_for(std::string(100'000, 'x'), Hashes{"only", "only"}) == 0);
}

TEST_CASE("another user takes some names, and one who goes leaves the others theirs")
{
    const auto before = stand_ins({"one", "two", "three"});
    const auto after = stand_ins({"one", "two", "three", "four"});
    std::size_t moved = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
        if (after[i] != before[i]) {
            CHECK(after[i] == "four");
            ++moved;
        }
    }
    CHECK(moved > 40);
    CHECK(moved < 110);
}

} // namespace stand_in_test
