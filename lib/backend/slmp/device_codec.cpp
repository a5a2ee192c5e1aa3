#include <algorithm>
#include <array>

#include "backend/slmp/codec.hpp"

namespace busbar::backend::detail {

namespace {

using binary::Reader;
using binary::Writer;
using Blocks = std::vector<SlmpBlock>;

constexpr std::size_t max_listed = 255;

void put_device(Writer& writer, const SlmpForm& form, const SlmpDevice& device)
{
    const bool fits = form.is_long || (device.number <= 0xFFFFFF && device.code <= 0xFF);
    if (!fits || (device.direct_memory == 0 && device.extension != 0)) {
        writer.fail(status::Bad_InvalidArgument);
        return;
    }
    // Modification by an index register and indirect specification are not used.
    if (form.is_extended) {
        writer.number(std::uint16_t{0});
    }
    if (form.is_long) {
        writer.number(device.number);
        writer.number(device.code);
    } else {
        writer.number(static_cast<std::uint16_t>(device.number));
        writer.number(static_cast<std::uint8_t>(device.number >> 16U));
        writer.number(static_cast<std::uint8_t>(device.code));
    }
    if (form.is_extended) {
        writer.number(std::uint16_t{0});
        writer.number(device.extension);
        writer.number(device.direct_memory);
    }
}

/// Reads a device. False if it is modified or indirect.
bool take_device(Reader& reader, const SlmpForm& form, SlmpDevice& device)
{
    bool is_plain = true;
    if (form.is_extended) {
        is_plain = reader.number<std::uint16_t>() == 0;
    }
    if (form.is_long) {
        device.number = reader.number<std::uint32_t>();
        device.code = reader.number<std::uint16_t>();
    } else {
        device.number = reader.number<std::uint16_t>();
        device.number |= std::uint32_t{reader.number<std::uint8_t>()} << 16U;
        device.code = reader.number<std::uint8_t>();
    }
    if (form.is_extended) {
        is_plain = reader.number<std::uint16_t>() == 0 && is_plain;
        device.extension = reader.number<std::uint16_t>();
        device.direct_memory = reader.number<std::uint8_t>();
        is_plain = is_plain && (device.direct_memory != 0 || device.extension == 0);
    }
    return is_plain;
}

std::size_t points_of(const Blocks& blocks)
{
    std::size_t points = 0;
    for (const SlmpBlock& block : blocks) {
        points += block.points;
    }
    return points;
}

/// Number of words of the values that an operation has or gets.
std::size_t value_count(const SlmpOperation& operation)
{
    switch (operation.command) {
    case SlmpCommand::BlockRead:
    case SlmpCommand::BlockWrite:
        return points_of(operation.blocks) + points_of(operation.more_blocks);
    case SlmpCommand::BatchRead:
    case SlmpCommand::BatchWrite:
        return points_of(operation.blocks);
    default:
        return operation.blocks.size() + 2 * operation.more_blocks.size();
    }
}

/// Bits of a batch have four bits each, the first one the high ones.
void put_bits(Writer& writer, std::span<const std::uint16_t> bits)
{
    for (std::size_t at = 0; at < bits.size(); at += 2) {
        const unsigned high = bits[at] != 0 ? 0x10U : 0U;
        const unsigned low = at + 1 < bits.size() && bits[at + 1] != 0 ? 1U : 0U;
        writer.number(static_cast<std::uint8_t>(high | low));
    }
}

/// Reads such bits. False if one has another value than 0 and 1.
bool take_bits(Reader& reader, std::size_t count, std::vector<std::uint16_t>& bits)
{
    const auto bytes = reader.bytes((count + 1) / 2);
    bool are_bits = true;
    for (const std::byte byte : bytes) {
        const auto both = std::to_integer<unsigned>(byte);
        are_bits = are_bits && (both & 0xEEU) == 0;
        bits.push_back(static_cast<std::uint16_t>(both >> 4U & 1U));
        bits.push_back(static_cast<std::uint16_t>(both & 1U));
    }
    if (count % 2 != 0 && !bits.empty()) {
        are_bits = are_bits && bits.back() == 0;
        bits.pop_back();
    }
    return are_bits;
}

void take_words(Reader& reader, std::size_t count, std::vector<std::uint16_t>& words)
{
    if (count * 2 > reader.remaining()) {
        reader.fail(status::Bad_DecodingError);
        return;
    }
    words.resize(count);
    reader.numbers(std::span{words});
}

void put_values(Writer& writer, const SlmpOperation& operation,
                const std::vector<std::uint16_t>& words)
{
    if (words.size() != value_count(operation)) {
        writer.fail(status::Bad_InvalidArgument);
    } else if (operation.is_bits) {
        put_bits(writer, words);
    } else {
        writer.numbers(std::span{words});
    }
}

void encode_words(Writer& writer, const SlmpOperation& operation, const SlmpAnswer& answer)
{
    put_values(writer, operation, answer.words);
}

void decode_words(Reader& reader, const SlmpOperation& operation, SlmpAnswer& answer)
{
    const std::size_t count = value_count(operation);
    if (!operation.is_bits) {
        take_words(reader, count, answer.words);
    } else if (!take_bits(reader, count, answer.words)) {
        reader.fail(status::Bad_DecodingError);
    }
}

// One block: batch read and write.

void put_batch(Writer& writer, const SlmpForm& form, const SlmpOperation& operation)
{
    if (operation.blocks.size() != 1 || !operation.more_blocks.empty()) {
        writer.fail(status::Bad_InvalidArgument);
        return;
    }
    put_device(writer, form, operation.blocks[0].device);
    writer.number(operation.blocks[0].points);
    if (operation.command == SlmpCommand::BatchWrite) {
        put_values(writer, operation, operation.words);
    }
}

std::uint16_t take_batch(Reader& reader, const SlmpForm& form, SlmpOperation& operation)
{
    SlmpBlock& block = operation.blocks.emplace_back();
    const bool is_plain = take_device(reader, form, block.device);
    block.points = reader.number<std::uint16_t>();
    bool are_bits = true;
    if (operation.command == SlmpCommand::BatchWrite && form.is_bits) {
        are_bits = take_bits(reader, block.points, operation.words);
    } else if (operation.command == SlmpCommand::BatchWrite) {
        take_words(reader, block.points, operation.words);
    }
    return !is_plain ? end_code_content : are_bits ? 0 : end_code_bits;
}

// Lists of devices: random read, monitor, random write.

void put_listed(Writer& writer, const SlmpForm& form, const SlmpOperation& operation)
{
    const bool is_write = operation.command == SlmpCommand::RandomWrite;
    const auto is_one = [](const SlmpBlock& block) { return block.points == 1; };
    const bool fits = operation.blocks.size() <= max_listed &&
                      operation.more_blocks.size() <= max_listed &&
                      std::ranges::all_of(operation.blocks, is_one) &&
                      std::ranges::all_of(operation.more_blocks, is_one) &&
                      (!form.is_bits || operation.more_blocks.empty()) &&
                      (!is_write || operation.words.size() == value_count(operation));
    if (!fits) {
        writer.fail(status::Bad_InvalidArgument);
        return;
    }
    writer.number(static_cast<std::uint8_t>(operation.blocks.size()));
    if (!form.is_bits) {
        writer.number(static_cast<std::uint8_t>(operation.more_blocks.size()));
    }
    std::size_t next = 0;
    for (const SlmpBlock& block : operation.blocks) {
        put_device(writer, form, block.device);
        if (is_write && form.is_bits && !form.is_long) {
            writer.number(static_cast<std::uint8_t>(operation.words[next++] != 0 ? 1 : 0));
        } else if (is_write) {
            const std::uint16_t word = operation.words[next++];
            writer.number(static_cast<std::uint16_t>(form.is_bits && word != 0 ? 1 : word));
        }
    }
    for (const SlmpBlock& block : operation.more_blocks) {
        put_device(writer, form, block.device);
        if (is_write) {
            writer.number(operation.words[next++]);
            writer.number(operation.words[next++]);
        }
    }
}

std::uint16_t take_listed(Reader& reader, const SlmpForm& form, SlmpOperation& operation)
{
    const bool is_write = operation.command == SlmpCommand::RandomWrite;
    const std::size_t count = reader.number<std::uint8_t>();
    const std::size_t more = form.is_bits ? 0 : reader.number<std::uint8_t>();
    bool is_plain = true;
    bool are_bits = true;
    for (std::size_t i = 0; i < count && reader.ok(); ++i) {
        is_plain = take_device(reader, form, operation.blocks.emplace_back().device) && is_plain;
        if (is_write) {
            operation.words.push_back(form.is_bits && !form.is_long
                                          ? reader.number<std::uint8_t>()
                                          : reader.number<std::uint16_t>());
            are_bits = are_bits && (!form.is_bits || operation.words.back() <= 1);
        }
    }
    for (std::size_t i = 0; i < more && reader.ok(); ++i) {
        is_plain =
            take_device(reader, form, operation.more_blocks.emplace_back().device) && is_plain;
        if (is_write) {
            operation.words.push_back(reader.number<std::uint16_t>());
            operation.words.push_back(reader.number<std::uint16_t>());
        }
    }
    return !is_plain ? end_code_content : are_bits ? 0 : end_code_bits;
}

// Blocks of words and of bits.

void put_blocks(Writer& writer, const SlmpForm& form, const SlmpOperation& operation)
{
    const bool is_write = operation.command == SlmpCommand::BlockWrite;
    if (operation.blocks.size() > max_listed || operation.more_blocks.size() > max_listed ||
        (is_write && operation.words.size() != value_count(operation))) {
        writer.fail(status::Bad_InvalidArgument);
        return;
    }
    writer.number(static_cast<std::uint8_t>(operation.blocks.size()));
    writer.number(static_cast<std::uint8_t>(operation.more_blocks.size()));
    std::span<const std::uint16_t> rest{operation.words};
    for (const Blocks* const blocks : {&operation.blocks, &operation.more_blocks}) {
        for (const SlmpBlock& block : *blocks) {
            put_device(writer, form, block.device);
            writer.number(block.points);
            if (is_write) {
                writer.numbers(rest.first(block.points));
                rest = rest.subspan(block.points);
            }
        }
    }
}

std::uint16_t take_blocks(Reader& reader, const SlmpForm& form, SlmpOperation& operation)
{
    const bool is_write = operation.command == SlmpCommand::BlockWrite;
    const std::array counts{std::size_t{reader.number<std::uint8_t>()},
                            std::size_t{reader.number<std::uint8_t>()}};
    bool is_plain = true;
    for (std::size_t kind = 0; kind < counts.size(); ++kind) {
        Blocks& blocks = kind == 0 ? operation.blocks : operation.more_blocks;
        for (std::size_t i = 0; i < counts[kind] && reader.ok(); ++i) {
            SlmpBlock& block = blocks.emplace_back();
            is_plain = take_device(reader, form, block.device) && is_plain;
            block.points = reader.number<std::uint16_t>();
            if (is_write) {
                std::vector<std::uint16_t> words;
                take_words(reader, block.points, words);
                operation.words.insert(operation.words.end(), words.begin(), words.end());
            }
        }
    }
    return is_plain ? 0 : end_code_content;
}

} // namespace

const SlmpCommandCodec batch_read{SlmpCommand::BatchRead, true,        true, put_batch, take_batch,
                                  encode_words,           decode_words};
const SlmpCommandCodec batch_write{
    SlmpCommand::BatchWrite, true, true, put_batch, take_batch, encode_nothing, decode_nothing};
const SlmpCommandCodec random_read{
    SlmpCommand::RandomRead, true, false, put_listed, take_listed, encode_words, decode_words};
const SlmpCommandCodec random_write{
    SlmpCommand::RandomWrite, true, true, put_listed, take_listed, encode_nothing, decode_nothing};
const SlmpCommandCodec register_monitor{SlmpCommand::RegisterMonitor,
                                        true,
                                        false,
                                        put_listed,
                                        take_listed,
                                        encode_nothing,
                                        decode_nothing};
// It names no devices: the operation has those that were registered.
const SlmpCommandCodec read_monitor{
    SlmpCommand::ReadMonitor, false, false, put_nothing, take_nothing, encode_words, decode_words};
const SlmpCommandCodec block_read{
    SlmpCommand::BlockRead, true, false, put_blocks, take_blocks, encode_words, decode_words};
const SlmpCommandCodec block_write{
    SlmpCommand::BlockWrite, true, false, put_blocks, take_blocks, encode_nothing, decode_nothing};

} // namespace busbar::backend::detail
