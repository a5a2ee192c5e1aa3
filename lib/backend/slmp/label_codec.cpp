#include "backend/slmp/codec.hpp"

namespace busbar::backend::detail {

namespace {

using binary::Reader;
using binary::Writer;

constexpr std::uint8_t unit_bits = 0;
constexpr std::uint8_t unit_bytes = 1;

bool is_array(SlmpCommand command)
{
    return command == SlmpCommand::LabelArrayRead || command == SlmpCommand::LabelArrayWrite;
}

bool is_write(SlmpCommand command)
{
    return command == SlmpCommand::LabelArrayWrite || command == SlmpCommand::LabelRandomWrite;
}

/// Bits are packed 16 to a word, and the rest of the last one is 0.
std::size_t size_of(bool is_in_bits, std::size_t length)
{
    return is_in_bits ? (length + 15) / 16 * 2 : length;
}

void put_label(Writer& writer, SlmpCommand command, const SlmpLabel& label)
{
    if (!write_utf16(writer, label.name)) {
        writer.fail(status::Bad_InvalidArgument);
        return;
    }
    std::size_t size = label.data.size();
    if (is_array(command)) {
        writer.number(label.is_in_bits ? unit_bits : unit_bytes);
        writer.number(std::uint8_t{0});
        writer.number(label.length);
        size = size_of(label.is_in_bits, label.length);
    } else if (is_write(command)) {
        writer.number(static_cast<std::uint16_t>(size));
    }
    if (is_write(command)) {
        if (size != label.data.size() || size > UINT16_MAX) {
            writer.fail(status::Bad_InvalidArgument);
            return;
        }
        writer.bytes(label.data);
    }
}

void put_labels(Writer& writer, const SlmpForm& /*form*/, const SlmpOperation& operation)
{
    if (operation.labels.size() > UINT16_MAX || operation.abbreviations.size() > UINT16_MAX) {
        writer.fail(status::Bad_InvalidArgument);
        return;
    }
    writer.number(static_cast<std::uint16_t>(operation.labels.size()));
    writer.number(static_cast<std::uint16_t>(operation.abbreviations.size()));
    for (const std::string& abbreviation : operation.abbreviations) {
        if (!write_utf16(writer, abbreviation)) {
            writer.fail(status::Bad_InvalidArgument);
        }
    }
    for (const SlmpLabel& label : operation.labels) {
        put_label(writer, operation.command, label);
    }
}

/// Reads a label; an end code if it is wrong.
std::uint16_t take_label(Reader& reader, SlmpCommand command, SlmpLabel& label)
{
    auto name = read_utf16(reader);
    if (!name) {
        return end_code_length;
    }
    label.name = std::move(*name);
    std::size_t size = 0;
    if (is_array(command)) {
        const auto unit = reader.number<std::uint8_t>();
        const auto fixed = reader.number<std::uint8_t>();
        label.length = reader.number<std::uint16_t>();
        label.is_in_bits = unit == unit_bits;
        size = size_of(label.is_in_bits, label.length);
        if (reader.ok() && (unit > unit_bytes || fixed != 0)) {
            return end_code_content;
        }
    } else if (is_write(command)) {
        size = reader.number<std::uint16_t>();
    }
    if (is_write(command)) {
        const auto data = reader.bytes(size);
        label.data.assign(data.begin(), data.end());
    }
    return 0;
}

std::uint16_t take_labels(Reader& reader, const SlmpForm& /*form*/, SlmpOperation& operation)
{
    const std::size_t count = reader.number<std::uint16_t>();
    const std::size_t abbreviations = reader.number<std::uint16_t>();
    for (std::size_t i = 0; i < abbreviations && reader.ok(); ++i) {
        auto text = read_utf16(reader);
        if (!text) {
            return end_code_length;
        }
        operation.abbreviations.push_back(std::move(*text));
    }
    for (std::size_t i = 0; i < count && reader.ok(); ++i) {
        const auto end_code =
            take_label(reader, operation.command, operation.labels.emplace_back());
        if (end_code != 0) {
            return end_code;
        }
    }
    return 0;
}

std::size_t size_of(const SlmpOperation& operation, const SlmpLabelValue& value)
{
    return size_of(is_array(operation.command) && value.unit == unit_bits, value.length);
}

void encode_values(Writer& writer, const SlmpOperation& operation, const SlmpAnswer& answer)
{
    if (answer.labels.size() != operation.labels.size()) {
        writer.fail(status::Bad_InvalidArgument);
        return;
    }
    writer.number(static_cast<std::uint16_t>(answer.labels.size()));
    for (const SlmpLabelValue& value : answer.labels) {
        if (value.data.size() != size_of(operation, value)) {
            writer.fail(status::Bad_InvalidArgument);
            return;
        }
        writer.number(value.type);
        writer.number(value.unit);
        writer.number(value.length);
        writer.bytes(value.data);
    }
}

void decode_values(Reader& reader, const SlmpOperation& operation, SlmpAnswer& answer)
{
    if (reader.number<std::uint16_t>() != operation.labels.size()) {
        reader.fail(status::Bad_DecodingError);
    }
    while (reader.ok() && answer.labels.size() < operation.labels.size()) {
        SlmpLabelValue& value = answer.labels.emplace_back();
        value.type = reader.number<std::uint8_t>();
        value.unit = reader.number<std::uint8_t>();
        value.length = reader.number<std::uint16_t>();
        const auto data = reader.bytes(size_of(operation, value));
        value.data.assign(data.begin(), data.end());
    }
}

} // namespace

const SlmpCommandCodec label_array_read{SlmpCommand::LabelArrayRead,
                                        false,
                                        false,
                                        put_labels,
                                        take_labels,
                                        encode_values,
                                        decode_values};
const SlmpCommandCodec label_array_write{SlmpCommand::LabelArrayWrite,
                                         false,
                                         false,
                                         put_labels,
                                         take_labels,
                                         encode_nothing,
                                         decode_nothing};
const SlmpCommandCodec label_random_read{SlmpCommand::LabelRandomRead,
                                         false,
                                         false,
                                         put_labels,
                                         take_labels,
                                         encode_values,
                                         decode_values};
const SlmpCommandCodec label_random_write{SlmpCommand::LabelRandomWrite,
                                          false,
                                          false,
                                          put_labels,
                                          take_labels,
                                          encode_nothing,
                                          decode_nothing};

} // namespace busbar::backend::detail
