#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <string_view>

#include <catch2/catch.hpp>

#include <busbar/server/worst_case_memory.hpp>

#include "support/allocation_count.hpp"

namespace busbar::test {

/// What the rows of these limits have together.
inline std::size_t rows(const server::ServerLimits& limits,
                        std::initializer_list<std::string_view> names)
{
    std::uint64_t sum = 0;
    for (const std::string_view name : names) {
        bool is_there = false;
        for (const server::MemoryRow& row : server::worst_case_memory(limits).rows) {
            sum += row.limit == name ? row.bytes() : 0;
            is_there = is_there || row.limit == name;
        }
        REQUIRE(is_there);
    }
    return sum;
}

/// What is held more than when this was made.
class Growth {
public:
    [[nodiscard]] std::size_t now() const { return above(held_bytes()); }
    /// The most since then.
    [[nodiscard]] std::size_t peak() const { return above(peak_bytes()); }

private:
    [[nodiscard]] std::size_t above(std::size_t bytes) const
    {
        return bytes - std::min(bytes, before_);
    }
    [[nodiscard]] static std::size_t begin()
    {
        forget_peak();
        return held_bytes();
    }
    std::size_t before_{begin()};
};

/// A client's own buffers and what it keeps of a message.
inline constexpr std::size_t of_client = 200'000;

} // namespace busbar::test
