#include <algorithm>
#include <charconv>

#include "core/ascii_case.hpp"
#include "harness/slmp/plc_memory.hpp"

namespace busbar::harness::detail {

namespace {

using backend::SlmpAnswer;
using backend::SlmpCommand;
using backend::SlmpLabel;
using backend::SlmpOperation;

constexpr std::uint16_t end_code_unknown_label = 0x40C0;
constexpr std::uint16_t end_code_content = 0xC05C;
constexpr std::uint16_t end_code_too_much = 0xC054;
constexpr std::uint16_t end_code_length = 0xC061;
constexpr std::uint8_t type_bit = 1;

std::string lower(std::string_view text)
{
    std::string result{text};
    std::ranges::transform(result, result.begin(), busbar::detail::to_ascii_lower);
    return result;
}

/// Replaces "%1" between dots; nothing if there is no such abbreviation.
std::optional<std::string> expand(std::string_view name, std::span<const std::string> abbreviations)
{
    std::string full;
    while (true) {
        const std::size_t end = std::min(name.find('.'), name.size());
        const std::string_view part = name.substr(0, end);
        if (part.starts_with('%')) {
            std::size_t number = 0;
            const auto read = std::from_chars(part.data() + 1, part.data() + part.size(), number);
            if (read.ec != std::errc{} || read.ptr != part.data() + part.size() || number == 0 ||
                number > abbreviations.size()) {
                return std::nullopt;
            }
            full += abbreviations[number - 1];
        } else {
            full += part;
        }
        if (end == name.size()) {
            return full;
        }
        full += '.';
        name.remove_prefix(end + 1);
    }
}

} // namespace

void PlcLabels::add(std::string_view name, Label label)
{
    label.element_size = std::max<std::size_t>(label.element_size, 1);
    labels_.insert_or_assign(lower(name), std::move(label));
}

const PlcLabels::Label* PlcLabels::find(std::string_view name) const
{
    const auto found = labels_.find(lower(name));
    return found == labels_.end() ? nullptr : &found->second;
}

std::optional<PlcLabels::Place> PlcLabels::resolve(std::string_view name,
                                                   std::span<const std::string> abbreviations)
{
    const auto full = expand(name, abbreviations);
    if (!full) {
        return std::nullopt;
    }
    const std::string key = lower(*full);
    if (const auto whole = labels_.find(key); whole != labels_.end()) {
        return Place{&whole->second, 0};
    }
    const std::size_t bracket = key.rfind('[');
    if (bracket == std::string::npos || !key.ends_with(']')) {
        return std::nullopt;
    }
    const auto array = labels_.find(key.substr(0, bracket));
    std::string_view index{key};
    index = index.substr(bracket + 1, index.size() - bracket - 2);
    const int base = index.starts_with('h') ? 16 : 10;
    if (index.starts_with('h') || index.starts_with('k')) {
        index.remove_prefix(1);
    }
    std::uint32_t number = 0;
    const auto read = std::from_chars(index.data(), index.data() + index.size(), number, base);
    if (array == labels_.end() || read.ec != std::errc{} ||
        read.ptr != index.data() + index.size()) {
        return std::nullopt;
    }
    const std::size_t offset = std::size_t{number} * array->second.element_size;
    if (offset >= array->second.value.size()) {
        return std::nullopt;
    }
    return Place{&array->second, offset};
}

std::uint16_t PlcLabels::read(const Place& place, const SlmpLabel& label, bool is_array,
                              SlmpAnswer& answer)
{
    const bool is_bit = place.label->type == type_bit;
    const std::size_t left = place.label->value.size() - place.offset;
    const std::byte* const from = place.label->value.data() + place.offset;
    auto& value = answer.labels.emplace_back();
    value.type = place.label->type;
    if (is_array) {
        value.unit = label.is_in_bits ? 0 : 1;
        value.length = label.length;
    } else {
        value.length = is_bit ? 2 : static_cast<std::uint16_t>(place.label->element_size);
    }
    const std::size_t count = is_bit && !is_array ? 1 : value.length;
    if ((is_array && label.is_in_bits != is_bit) || count > left) {
        return end_code_content;
    }
    if (!is_bit) {
        value.data.assign(from, from + count);
        return 0;
    }
    value.data.resize((count + 15) / 16 * 2);
    for (std::size_t bit = 0; bit < count; ++bit) {
        value.data[bit / 8] |= (from[bit] & std::byte{1}) << (bit % 8);
    }
    return 0;
}

std::uint16_t PlcLabels::write(const Place& place, const SlmpLabel& label, bool is_array)
{
    const bool is_bit = place.label->type == type_bit;
    const std::size_t left = place.label->value.size() - place.offset;
    const std::size_t expected = is_array ? label.length : is_bit ? 1 : place.label->element_size;
    if ((is_array && label.is_in_bits != is_bit) || expected > left) {
        return end_code_content;
    }
    if (!is_array && label.data.size() != (is_bit ? 2 : expected)) {
        return end_code_length;
    }
    std::byte* const to = place.label->value.data() + place.offset;
    for (std::size_t at = 0; at < expected; ++at) {
        to[at] = is_bit ? (label.data[at / 8] >> (at % 8)) & std::byte{1} : label.data[at];
    }
    return 0;
}

std::uint16_t PlcLabels::serve(const SlmpOperation& operation, SlmpAnswer& answer)
{
    const bool is_array = operation.command == SlmpCommand::LabelArrayRead ||
                          operation.command == SlmpCommand::LabelArrayWrite;
    const bool is_read = operation.command == SlmpCommand::LabelArrayRead ||
                         operation.command == SlmpCommand::LabelRandomRead;
    std::vector<Place> places;
    for (const SlmpLabel& label : operation.labels) {
        const auto place = resolve(label.name, operation.abbreviations);
        if (!place) {
            return end_code_unknown_label;
        }
        places.push_back(*place);
    }
    std::size_t size = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const SlmpLabel& label = operation.labels[i];
        const std::uint16_t end_code =
            is_read ? read(places[i], label, is_array, answer) : write(places[i], label, is_array);
        if (end_code != 0) {
            return end_code;
        }
        size += is_read ? answer.labels.back().data.size() : 0;
        if (size > UINT16_MAX) {
            return end_code_too_much;
        }
    }
    return 0;
}

} // namespace busbar::harness::detail
