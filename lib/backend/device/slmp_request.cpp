#include "slmp_request.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace busbar::backend::detail {

namespace {

constexpr std::uint32_t bits_of_word = 16;
/// The words that a block takes of those of a block write, as R08CPU was measured.
constexpr std::uint32_t cost_of_written_block = 9;

/// Contacts and coils of timers and counters, which random and block reads must not name.
bool is_contact_or_coil(std::uint32_t area)
{
    constexpr std::array<std::uint32_t, 12> codes{0xC1, 0xC0, 0xC7, 0xC6, 0xC4, 0xC3,
                                                  0x51, 0x50, 0x59, 0x58, 0x55, 0x54};
    return std::ranges::find(codes, area & 0xFFU) != codes.end();
}

/// The words that bits are in: devices are named by the first bit of a word then.
struct WordsOfBits {
    explicit WordsOfBits(const PlanAddress& range)
        : first{range.offset / bits_of_word * bits_of_word},
          count{(range.offset - first + range.width + bits_of_word - 1) / bits_of_word}
    {
    }

    std::uint32_t first;
    std::uint32_t count;
};

bool is_bits(const PlanAddress& range)
{
    return unit_of(range.area) == SlmpUnit::Bit;
}

std::uint32_t words_per_unit(std::uint32_t area)
{
    return unit_of(area) == SlmpUnit::DoubleWord ? 2 : 1;
}

SlmpDevice device_at(const PlanAddress& range, std::uint32_t number)
{
    SlmpDevice device = device_of(range);
    device.number = number;
    return device;
}

/// Words that a read of several ranges takes.
std::uint64_t total_of(const PlanRequest& request)
{
    std::uint64_t words = 0;
    for (const PlanAddress& range : request.ranges) {
        words += is_bits(range) && !request.is_write
                     ? WordsOfBits{range}.count
                     : std::uint64_t{range.width} * words_per_unit(range.area);
    }
    return words;
}

/// Names each word, double word or bit by itself.
void list(const PlanRequest& request, SlmpOperation& operation)
{
    for (const PlanAddress& range : request.ranges) {
        const bool is_word_of_bits = is_bits(range) && !request.is_write;
        const WordsOfBits words{range};
        const std::uint32_t count = is_word_of_bits ? words.count : range.width;
        const std::uint32_t step = is_word_of_bits ? bits_of_word : 1;
        auto& points =
            unit_of(range.area) == SlmpUnit::DoubleWord ? operation.more_blocks : operation.blocks;
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::uint32_t first = is_word_of_bits ? words.first : range.offset;
            points.push_back({device_at(range, first + i * step), 1});
        }
    }
}

/// Names each range, those of bits by the words that these are in.
void list_blocks(const PlanRequest& request, SlmpOperation& operation)
{
    for (const PlanAddress& range : request.ranges) {
        if (is_bits(range)) {
            const WordsOfBits words{range};
            operation.more_blocks.push_back(
                {device_at(range, words.first), static_cast<std::uint16_t>(words.count)});
        } else {
            operation.blocks.push_back(
                {device_of(range),
                 static_cast<std::uint16_t>(range.width * words_per_unit(range.area))});
        }
    }
}

} // namespace

bool is_io(const PlanAddress& address)
{
    constexpr std::uint32_t x = 0x9C;
    constexpr std::uint32_t y = 0x9D;
    return address.area == x || address.area == y;
}

PlanRule rule_of(std::uint32_t area, const SlmpProtocolOptions& options, const SlmpLimits& limits)
{
    constexpr std::uint32_t of_modules = 2;
    // A word read in vain costs less than one named in a list, of which a request has so many
    // fewer.
    constexpr std::uint32_t max_gap_in_list = 8;
    const bool has_bits = unit_of(area) == SlmpUnit::Bit;
    const std::uint32_t max_words = options.max_words;
    const auto within = [&](std::uint32_t words) { return std::min(words, max_words); };
    PlanRule rule;
    rule.area = area;
    rule.words_per_unit = words_per_unit(area);
    rule.max_read = has_bits ? std::min<std::uint32_t>(options.max_bits, limits.bits)
                             : std::max(max_words / rule.words_per_unit, 1U);
    rule.max_write = rule.max_read;
    rule.max_gap = options.max_gap;
    if (!is_contact_or_coil(area)) {
        rule.read.group = is_extended(area) ? of_modules : 1;
        rule.read.units_per_word = has_bits ? bits_of_word : 1;
        rule.read.max_listed =
            within(is_extended(area) ? limits.random_read_extended : limits.random_read);
        rule.read.max_ranges = is_extended(area) ? 1 : limits.read_blocks;
        rule.read.max_words = max_words;
        if (rule.read.max_listed > 0) {
            rule.max_gap = std::min(rule.max_gap, max_gap_in_list);
        }
    }
    rule.max_gap *= has_bits ? bits_of_word : 1;
    // Double words have a list of their own in a random write, which comes after that of words.
    if (has_bits && !is_extended(area)) {
        rule.write.group = 1;
        rule.write.max_listed = limits.random_write_bits;
    } else if (rule.words_per_unit == 1 && !is_extended(area)) {
        rule.write.group = 2;
        rule.write.max_listed = within(limits.random_write);
        rule.write.max_ranges = limits.write_blocks;
        rule.write.max_words = max_words;
        rule.write.range_cost = cost_of_written_block;
    }
    return rule;
}

SlmpOperation operation_of(const PlanRequest& request, const SlmpFindings& findings)
{
    SlmpOperation operation;
    operation.has_long_form = findings.has_long_form;
    operation.words = request.words;
    const PlanAddress& range = request.ranges.front();
    if (request.ranges.size() == 1) {
        operation.command = request.is_write ? SlmpCommand::BatchWrite : SlmpCommand::BatchRead;
        operation.is_bits = is_bits(range);
        operation.blocks.push_back(
            {device_of(range),
             static_cast<std::uint16_t>(range.width * words_per_unit(range.area))});
        return operation;
    }
    operation.is_bits = request.is_write && is_bits(range);
    const SlmpLimits limits = limits_of(findings, false);
    const std::uint32_t listed = operation.is_bits         ? limits.random_write_bits
                                 : request.is_write        ? limits.random_write
                                 : is_extended(range.area) ? limits.random_read_extended
                                                           : limits.random_read;
    if (total_of(request) <= listed) {
        operation.command = request.is_write ? SlmpCommand::RandomWrite : SlmpCommand::RandomRead;
        list(request, operation);
    } else {
        operation.command = request.is_write ? SlmpCommand::BlockWrite : SlmpCommand::BlockRead;
        list_blocks(request, operation);
    }
    return operation;
}

std::vector<std::uint16_t> words_of(const PlanRequest& request, SlmpCommand command,
                                    std::vector<std::uint16_t> answer)
{
    if (command != SlmpCommand::RandomRead && command != SlmpCommand::BlockRead) {
        return answer;
    }
    // The answer has all of one list before the other one.
    const bool is_listed = command == SlmpCommand::RandomRead;
    const auto is_second = [&](const PlanAddress& range) {
        return is_listed ? unit_of(range.area) == SlmpUnit::DoubleWord : is_bits(range);
    };
    const auto count_of = [](const PlanAddress& range) {
        return is_bits(range) ? std::size_t{WordsOfBits{range}.count}
                              : std::size_t{range.width} * words_per_unit(range.area);
    };
    std::size_t first = 0;
    std::size_t second = 0;
    for (const PlanAddress& range : request.ranges) {
        second += is_second(range) ? 0 : count_of(range);
    }
    std::vector<std::uint16_t> words;
    for (const PlanAddress& range : request.ranges) {
        std::size_t& at = is_second(range) ? second : first;
        const std::size_t count = count_of(range);
        if (count > answer.size() - std::min(at, answer.size())) {
            return {}; // the codec has checked the size
        }
        const auto part = std::span{answer}.subspan(at, count);
        at += count;
        if (!is_bits(range)) {
            words.insert(words.end(), part.begin(), part.end());
            continue;
        }
        const std::uint32_t shift = range.offset % bits_of_word;
        for (std::uint32_t bit = shift; bit < shift + range.width; ++bit) {
            words.push_back(
                static_cast<std::uint16_t>(part[bit / bits_of_word] >> bit % bits_of_word & 1U));
        }
    }
    return words;
}

} // namespace busbar::backend::detail
