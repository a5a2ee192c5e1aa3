#pragma once

#include <cstdint>

#include <busbar/core/built_in_type.hpp>

/// The encoding bytes that describe what follows, shared by decoding and checking code.
namespace busbar::detail {

/// Part 6, 5.2.2.16.
namespace variant_mask {
inline constexpr unsigned type = 0x3F;
inline constexpr unsigned dimensions = 0x40;
inline constexpr unsigned array = 0x80;

/// False for an unknown type, and for a matrix that is not an array.
[[nodiscard]] constexpr bool is_valid(unsigned mask)
{
    constexpr unsigned last_reserved_type = 31;
    const unsigned id = mask & type;
    return id != 0 && id <= last_reserved_type && ((mask & dimensions) == 0 || (mask & array) != 0);
}
/// Part 6, 5.1.2: the ids up to 31 that are not in use are read as ByteString.
[[nodiscard]] constexpr BuiltInType type_of(unsigned mask)
{
    const unsigned id = mask & type;
    return id > last_built_in_type ? BuiltInType::ByteString : static_cast<BuiltInType>(id);
}
} // namespace variant_mask

/// Part 6, 5.2.2.12.
namespace diagnostic_info_mask {
inline constexpr unsigned symbolic_id = 0x01;
inline constexpr unsigned namespace_uri = 0x02;
inline constexpr unsigned localized_text = 0x04;
inline constexpr unsigned locale = 0x08;
inline constexpr unsigned additional_info = 0x10;
inline constexpr unsigned inner_status_code = 0x20;
inline constexpr unsigned inner_diagnostic_info = 0x40;
inline constexpr unsigned reserved = 0x80;
} // namespace diagnostic_info_mask

} // namespace busbar::detail
