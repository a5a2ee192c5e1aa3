#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/core/date_time.hpp>

/// Values of the time types of OPC 30000, and of servers whose DataTypes have the names that IEC
/// 61131-3 gives them.
namespace busbar::binary::detail {

enum class IecKind : std::uint8_t { Duration, TimeOfDay, Date, DateAndTime };

struct IecType {
    IecKind kind;
    /// The unit of a value that is a number.
    std::int64_t nanoseconds;
};

/// Returns nothing for a type, which may be null, that is not TIME, TOD, DATE, DT or one of the
/// long forms.
[[nodiscard]] BUSBAR_API std::optional<IecType> iec_type(const DynamicType* type);
/// Returns "T#1s500ms" or "TOD#06:00:00"; empty if the number is not a time of this type.
[[nodiscard]] BUSBAR_API std::string iec_text(const IecType& type, std::int64_t number);
/// Returns "D#2026-11-29", "DT#2026-11-29-06:00:00" or "TOD#06:00:00"; empty for other kinds and
/// for no time.
[[nodiscard]] BUSBAR_API std::string iec_text(const IecType& type, DateTime time);
/// Reads a literal with what stands before its #, or without.
[[nodiscard]] BUSBAR_API std::optional<std::int64_t> iec_number(const IecType& type,
                                                                std::string_view text);
[[nodiscard]] BUSBAR_API std::optional<DateTime> iec_time(const IecType& type,
                                                          std::string_view text);

} // namespace busbar::binary::detail
