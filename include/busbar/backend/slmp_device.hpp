#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

/// The devices of Mitsubishi PLCs, as SLMP numbers them, and how their addresses are written.
namespace busbar::backend {

/// The size of the device that a number stands for.
enum class SlmpUnit : std::uint8_t {
    Bit,
    Word,
    DoubleWord, // two words, also where points are counted in words
    LongTimer,  // four words: current value of two, contact and coil, system
};

/// A kind of device.
struct SlmpDeviceType {
    /// The name that addresses begin with: "D".
    std::string_view name;
    /// On the wire; the short form has one byte of it.
    std::uint16_t code{0};
    /// Numbers are written in hexadecimal.
    bool is_hexadecimal{false};
    /// The size of one of them.
    SlmpUnit unit{SlmpUnit::Word};
    /// It can be in requests in the short form, that of Q and L.
    bool has_short_form{true};
    /// It is only there in a module: "U3E0\G10".
    bool is_in_module{false};
};

/// All kinds of devices.
[[nodiscard]] BUSBAR_API std::span<const SlmpDeviceType> slmp_device_types();
/// The kind with this code; null if there is none.
[[nodiscard]] BUSBAR_API const SlmpDeviceType* find_slmp_device_type(std::uint16_t code);

/// A device as requests name it.
struct SlmpDevice {
    /// SlmpDeviceType::code.
    std::uint16_t code{0};
    /// Its number, whatever the base is that it is written in.
    std::uint32_t number{0};
    /// The number of the module or network that it is in, if `direct_memory` says that it is in
    /// one.
    std::uint16_t extension{0};
    /// 0, or where it is: F8 a module's buffer memory, F9 a link, FA another CPU's buffer memory.
    std::uint8_t direct_memory{0};

    // NOLINTNEXTLINE(modernize-use-nullptr): the compiler's own comparison has a 0
    friend auto operator<=>(const SlmpDevice&, const SlmpDevice&) = default;
};

/// A device, or a bit of its word.
struct SlmpAddress {
    /// The device.
    SlmpDevice device;
    /// The bit of a word device, 0 to 15; nothing for the device itself.
    std::optional<std::uint8_t> bit{};

    friend bool operator==(const SlmpAddress&, const SlmpAddress&) = default;
};

/// The notation of addresses that a family of PLCs has.
struct SlmpNotation {
    /// X and Y in octal (FX5), else in hexadecimal.
    bool is_octal{false};
    /// ZR in hexadecimal, as some tools show it, else in decimal.
    bool is_zr_hexadecimal{false};
    /// The PLC takes the long form of requests, that of iQ-R.
    bool has_long_form{true};
};

/// Reads an address, without regard to case: "D100", "X1F", "D100.F" (bit 15), "U01\G22" (buffer
/// memory of a module), "U3E0\HG0" (of a CPU), "J1\W1A" (link device of a network).
///
/// Refused with `where` "column 2", counted from 1, and a text that says what was found and what
/// was expected: unknown devices, digits that the device's numbers do not have, numbers that no
/// request can have, bits of anything but a word, and devices that a PLC without the long form does
/// not have.
[[nodiscard]] BUSBAR_API Configured<SlmpAddress>
parse_slmp_address(std::string_view text, const SlmpNotation& notation = {});

/// Returns the canonical text, which reads as the same address: "X1F". Unknown codes are written as
/// "?4F:100".
[[nodiscard]] BUSBAR_API std::string to_text(const SlmpAddress& address,
                                             const SlmpNotation& notation = {});

} // namespace busbar::backend
