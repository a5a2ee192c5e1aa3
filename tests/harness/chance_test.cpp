#include <catch2/catch.hpp>

#include <cstdint>
#include <set>

#include <busbar/harness/chance.hpp>

namespace chance_test {

using busbar::harness::Chance;

TEST_CASE("the same seed and stream give the same numbers", "[harness]")
{
    Chance one{7, 3};
    Chance other{7, 3};
    for (int i = 0; i < 10; ++i) {
        CHECK(one.next() == other.next());
    }
}

TEST_CASE("seeds and streams that follow each other share no numbers", "[harness]")
{
    constexpr std::size_t numbers = 200;
    std::set<std::uint64_t> all;
    std::size_t drawn = 0;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        for (std::uint64_t stream = 0; stream < 10; ++stream) {
            Chance chance{seed, stream};
            for (std::size_t i = 0; i < numbers; ++i, ++drawn) {
                all.insert(chance.next());
            }
        }
    }
    CHECK(all.size() == drawn);
}

} // namespace chance_test
