#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string>
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

    friend constexpr auto operator<=>(const Guid&, const Guid&) = default;
};

/// Upper-case text form of Part 6, 5.1.3.
[[nodiscard]] BUSBAR_API std::string to_string(const Guid& guid);

} // namespace busbar
