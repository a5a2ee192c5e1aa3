#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>

namespace busbar {

/// Guid (Part 6, 5.2.2.6).
struct BUSBAR_API Guid {
    std::uint32_t data1{0};
    std::uint16_t data2{0};
    std::uint16_t data3{0};
    std::array<std::uint8_t, 8> data4{};

    /// Reads "72962B91-FA75-4AE6-8D28-B404DC7DAF63" in either case; else Bad_DecodingError.
    [[nodiscard]] static Result<Guid> parse(std::string_view text);

    friend constexpr bool operator==(const Guid&, const Guid&) = default;
    friend constexpr std::strong_ordering operator<=>(const Guid& a, const Guid& b)
    {
        if (a.data1 != b.data1) {
            return a.data1 <=> b.data1;
        }
        if (a.data2 != b.data2) {
            return a.data2 <=> b.data2;
        }
        if (a.data3 != b.data3) {
            return a.data3 <=> b.data3;
        }
        std::size_t i = 0;
        while (i + 1 < a.data4.size() && a.data4[i] == b.data4[i]) {
            ++i;
        }
        return a.data4[i] <=> b.data4[i];
    }
};

/// Upper-case text form of Part 6, 5.1.3.
[[nodiscard]] BUSBAR_API std::string to_string(const Guid& guid);

} // namespace busbar
