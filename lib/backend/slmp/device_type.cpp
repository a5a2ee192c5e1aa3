#include <busbar/backend/slmp_device.hpp>

#include <algorithm>
#include <array>

namespace busbar::backend {

namespace {

using enum SlmpUnit;

/// SH-080956ENG, device codes.
constexpr std::array types{
    SlmpDeviceType{"SM", 0x91, false, Bit},
    SlmpDeviceType{"SD", 0xA9, false, Word},
    SlmpDeviceType{"X", 0x9C, true, Bit},
    SlmpDeviceType{"Y", 0x9D, true, Bit},
    SlmpDeviceType{"M", 0x90, false, Bit},
    SlmpDeviceType{"L", 0x92, false, Bit},
    SlmpDeviceType{"F", 0x93, false, Bit},
    SlmpDeviceType{"V", 0x94, false, Bit},
    SlmpDeviceType{"B", 0xA0, true, Bit},
    SlmpDeviceType{"D", 0xA8, false, Word},
    SlmpDeviceType{"W", 0xB4, true, Word},
    SlmpDeviceType{"TS", 0xC1, false, Bit},
    SlmpDeviceType{"TC", 0xC0, false, Bit},
    SlmpDeviceType{"TN", 0xC2, false, Word},
    SlmpDeviceType{"STS", 0xC7, false, Bit},
    SlmpDeviceType{"STC", 0xC6, false, Bit},
    SlmpDeviceType{"STN", 0xC8, false, Word},
    SlmpDeviceType{"LTS", 0x51, false, Bit, false},
    SlmpDeviceType{"LTC", 0x50, false, Bit, false},
    SlmpDeviceType{"LTN", 0x52, false, LongTimer, false},
    SlmpDeviceType{"LSTS", 0x59, false, Bit, false},
    SlmpDeviceType{"LSTC", 0x58, false, Bit, false},
    SlmpDeviceType{"LSTN", 0x5A, false, LongTimer, false},
    SlmpDeviceType{"CS", 0xC4, false, Bit},
    SlmpDeviceType{"CC", 0xC3, false, Bit},
    SlmpDeviceType{"CN", 0xC5, false, Word},
    SlmpDeviceType{"LCS", 0x55, false, Bit, false},
    SlmpDeviceType{"LCC", 0x54, false, Bit, false},
    SlmpDeviceType{"LCN", 0x56, false, DoubleWord, false},
    SlmpDeviceType{"SB", 0xA1, true, Bit},
    SlmpDeviceType{"SW", 0xB5, true, Word},
    SlmpDeviceType{"DX", 0xA2, true, Bit},
    SlmpDeviceType{"DY", 0xA3, true, Bit},
    SlmpDeviceType{"Z", 0xCC, false, Word},
    SlmpDeviceType{"LZ", 0x62, false, DoubleWord, false},
    SlmpDeviceType{"R", 0xAF, false, Word},
    SlmpDeviceType{"ZR", 0xB0, false, Word},
    SlmpDeviceType{"RD", 0x2C, false, Word, false},
    SlmpDeviceType{"G", 0xAB, false, Word, true, true},
    SlmpDeviceType{"HG", 0x2E, false, Word, false, true},
};

} // namespace

std::span<const SlmpDeviceType> slmp_device_types()
{
    return types;
}

const SlmpDeviceType* find_slmp_device_type(std::uint16_t code)
{
    const auto* const found = std::find_if(
        types.begin(), types.end(), [&](const SlmpDeviceType& type) { return type.code == code; });
    return found == types.end() ? nullptr : found;
}

} // namespace busbar::backend
