#include "harness/slmp/plc_memory.hpp"

#include <algorithm>

namespace busbar::harness::detail {

using backend::SlmpDevice;
using backend::SlmpUnit;

SlmpDevice PlcMemory::key_of(const SlmpDevice& device)
{
    return {device.code, 0, device.extension, device.direct_memory};
}

bool PlcMemory::add(std::string_view kind, std::uint32_t count)
{
    const auto address = backend::parse_slmp_address(std::string{kind} + "0");
    if (!address) {
        return false;
    }
    const SlmpUnit unit = backend::find_slmp_device_type(address->device.code)->unit;
    Area area{unit == SlmpUnit::Bit};
    area.words_per_number = unit == SlmpUnit::LongTimer ? 4 : unit == SlmpUnit::DoubleWord ? 2 : 1;
    area.values.resize(std::size_t{count} * area.words_per_number);
    areas_.insert_or_assign(key_of(address->device), std::move(area));
    return true;
}

PlcMemory::Access PlcMemory::check(const SlmpDevice& device, std::size_t size,
                                   bool is_in_bits) const
{
    const auto found = areas_.find(key_of(device));
    if (found == areas_.end()) {
        // A module that is not there has no device, as a CPU without HG.
        return device.direct_memory != 0 ? Access::OutOfRange : Access::UnknownDevice;
    }
    const Area& area = found->second;
    if (is_in_bits && !area.has_bits) {
        return Access::NotInBits;
    }
    const std::size_t begin = std::size_t{device.number} * area.words_per_number;
    const std::size_t count = area.has_bits && !is_in_bits ? size * 16 : size;
    return begin >= area.values.size() || count > area.values.size() - begin ? Access::OutOfRange
                                                                             : Access::Done;
}

std::uint16_t PlcMemory::refusal(const SlmpDevice& device, std::size_t size, bool is_in_bits) const
{
    const auto area = areas_.find(key_of(device));
    if (area == areas_.end()) {
        return 0;
    }
    const Area& it = area->second;
    const std::size_t count = it.has_bits && !is_in_bits
                                  ? size * 16
                                  : (size + it.words_per_number - 1) / it.words_per_number;
    const auto hit = std::ranges::find_if(refused_, [&](const auto& refused) {
        const SlmpDevice& other = refused.first;
        return key_of(other) == key_of(device) && other.number >= device.number &&
               other.number - device.number < count;
    });
    return hit == refused_.end() ? std::uint16_t{0} : hit->second;
}

PlcMemory::Access PlcMemory::read_words(const SlmpDevice& device,
                                        std::span<std::uint16_t> words) const
{
    const Access access = check(device, words.size(), false);
    if (access != Access::Done) {
        return access;
    }
    const Area& area = areas_.at(key_of(device));
    std::size_t at = std::size_t{device.number} * area.words_per_number;
    for (std::uint16_t& word : words) {
        word = area.has_bits ? 0 : area.values[at++];
        for (unsigned bit = 0; area.has_bits && bit < 16; ++bit) {
            word = static_cast<std::uint16_t>(word | (area.values[at++] << bit));
        }
    }
    return Access::Done;
}

PlcMemory::Access PlcMemory::write_words(const SlmpDevice& device,
                                         std::span<const std::uint16_t> words)
{
    const Access access = check(device, words.size(), false);
    if (access != Access::Done) {
        return access;
    }
    Area& area = areas_.at(key_of(device));
    std::size_t at = std::size_t{device.number} * area.words_per_number;
    for (const std::uint16_t word : words) {
        if (!area.has_bits) {
            area.values[at++] = word;
        }
        for (unsigned bit = 0; area.has_bits && bit < 16; ++bit) {
            area.values[at++] = static_cast<std::uint16_t>(word >> bit & 1U);
        }
    }
    return Access::Done;
}

PlcMemory::Access PlcMemory::read_bits(const SlmpDevice& device,
                                       std::span<std::uint16_t> bits) const
{
    const Access access = check(device, bits.size(), true);
    if (access == Access::Done) {
        const auto& values = areas_.at(key_of(device)).values;
        std::copy_n(values.begin() + device.number, bits.size(), bits.begin());
    }
    return access;
}

PlcMemory::Access PlcMemory::write_bits(const SlmpDevice& device,
                                        std::span<const std::uint16_t> bits)
{
    const Access access = check(device, bits.size(), true);
    if (access == Access::Done) {
        std::transform(bits.begin(), bits.end(),
                       areas_.at(key_of(device)).values.begin() + device.number,
                       [](std::uint16_t bit) { return static_cast<std::uint16_t>(bit & 1U); });
    }
    return access;
}

} // namespace busbar::harness::detail
