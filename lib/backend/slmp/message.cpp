#include <busbar/backend/slmp_message.hpp>

#include <algorithm>
#include <array>

#include "backend/slmp/codec.hpp"

namespace busbar::backend {

namespace detail {

namespace {

using binary::Reader;
using binary::Writer;

constexpr std::size_t type_name_size = 16;
constexpr std::size_t max_self_test = 960;
constexpr std::size_t max_password = 32;

// Commands with a text after its length: self test, passwords.

std::size_t max_text(SlmpCommand command)
{
    return command == SlmpCommand::SelfTest ? max_self_test : max_password;
}

void put_text(Writer& writer, const std::string& text)
{
    writer.number(static_cast<std::uint16_t>(text.size()));
    writer.bytes(std::as_bytes(std::span{text}));
}

std::string take_text(Reader& reader, std::size_t size)
{
    const auto bytes = reader.bytes(size);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void put_text_request(Writer& writer, const SlmpForm& /*form*/, const SlmpOperation& operation)
{
    if (operation.text.empty() || operation.text.size() > max_text(operation.command)) {
        writer.fail(status::Bad_InvalidArgument);
        return;
    }
    put_text(writer, operation.text);
}

std::uint16_t take_text_request(Reader& reader, const SlmpForm& /*form*/, SlmpOperation& operation)
{
    const std::size_t size = reader.number<std::uint16_t>();
    operation.text = take_text(reader, size);
    const bool fits = size > 0 && size <= max_text(operation.command);
    return !reader.ok() || fits ? 0 : end_code_content;
}

void encode_self_test(Writer& writer, const SlmpOperation& /*operation*/, const SlmpAnswer& answer)
{
    put_text(writer, answer.text);
}

void decode_self_test(Reader& reader, const SlmpOperation& operation, SlmpAnswer& answer)
{
    answer.text = take_text(reader, reader.number<std::uint16_t>());
    if (answer.text != operation.text) {
        reader.fail(status::Bad_DecodingError);
    }
}

void encode_type_name(Writer& writer, const SlmpOperation& /*operation*/, const SlmpAnswer& answer)
{
    if (answer.text.size() > type_name_size) {
        writer.fail(status::Bad_InvalidArgument);
        return;
    }
    const std::string padded = answer.text + std::string(type_name_size - answer.text.size(), ' ');
    writer.bytes(std::as_bytes(std::span{padded}));
    writer.number(answer.model);
}

void decode_type_name(Reader& reader, const SlmpOperation& /*operation*/, SlmpAnswer& answer)
{
    answer.text = take_text(reader, type_name_size);
    answer.text.erase(answer.text.find_last_not_of(' ') + 1);
    answer.model = reader.number<std::uint16_t>();
}

// Remote control.

void put_run(Writer& writer, const SlmpForm& /*form*/, const SlmpOperation& operation)
{
    writer.number(operation.mode);
    writer.number(operation.clear);
    writer.number(std::uint8_t{0});
}

std::uint16_t take_run(Reader& reader, const SlmpForm& /*form*/, SlmpOperation& operation)
{
    operation.mode = reader.number<std::uint16_t>();
    operation.clear = reader.number<std::uint8_t>();
    const auto fixed = reader.number<std::uint8_t>();
    const bool is_right =
        (operation.mode == 1 || operation.mode == 3) && operation.clear <= 2 && fixed == 0;
    return !reader.ok() || is_right ? 0 : end_code_content;
}

void put_mode(Writer& writer, const SlmpForm& /*form*/, const SlmpOperation& operation)
{
    writer.number(operation.mode);
}

std::uint16_t take_mode(Reader& reader, const SlmpForm& /*form*/, SlmpOperation& operation)
{
    operation.mode = reader.number<std::uint16_t>();
    return 0;
}

constexpr SlmpCommandCodec without_answer(SlmpCommand command, EncodeSlmpRequest encode,
                                          DecodeSlmpRequest decode)
{
    return {command, false, false, encode, decode, encode_nothing, decode_nothing};
}

constexpr SlmpCommandCodec type_name{SlmpCommand::TypeName, false,        false,
                                     put_nothing,           take_nothing, encode_type_name,
                                     decode_type_name};
constexpr SlmpCommandCodec self_test{
    SlmpCommand::SelfTest, false,           false, put_text_request, take_text_request,
    encode_self_test,      decode_self_test};
constexpr auto unlock = without_answer(SlmpCommand::Unlock, put_text_request, take_text_request);
constexpr auto lock = without_answer(SlmpCommand::Lock, put_text_request, take_text_request);
constexpr auto run = without_answer(SlmpCommand::RemoteRun, put_run, take_run);
constexpr auto stop = without_answer(SlmpCommand::RemoteStop, put_mode, take_mode);
constexpr auto pause = without_answer(SlmpCommand::RemotePause, put_mode, take_mode);
constexpr auto latch_clear = without_answer(SlmpCommand::RemoteLatchClear, put_mode, take_mode);
constexpr auto reset = without_answer(SlmpCommand::RemoteReset, put_mode, take_mode);
constexpr auto clear_error = without_answer(SlmpCommand::ClearError, put_nothing, take_nothing);

constexpr std::array commands{
    &batch_read,
    &batch_write,
    &random_read,
    &random_write,
    &register_monitor,
    &read_monitor,
    &block_read,
    &block_write,
    &label_array_read,
    &label_array_write,
    &label_random_read,
    &type_name,
    &self_test,
    &unlock,
    &lock,
    &label_random_write,
    &run,
    &stop,
    &pause,
    &latch_clear,
    &reset,
    &clear_error,
};

} // namespace

std::optional<SlmpForm> SlmpForm::of(std::uint16_t subcommand)
{
    constexpr unsigned known = 0x83;
    if ((subcommand & ~known) != 0) {
        return std::nullopt;
    }
    return SlmpForm{(subcommand & 1U) != 0, (subcommand & 2U) != 0, (subcommand & 0x80U) != 0};
}

std::uint16_t SlmpForm::subcommand() const
{
    return static_cast<std::uint16_t>((is_bits ? 1U : 0U) | (is_long ? 2U : 0U) |
                                      (is_extended ? 0x80U : 0U));
}

const SlmpCommandCodec* find_slmp_command(std::uint16_t command)
{
    const auto* const found =
        std::find_if(commands.begin(), commands.end(), [&](const SlmpCommandCodec* codec) {
            return static_cast<std::uint16_t>(codec->command) == command;
        });
    return found == commands.end() ? nullptr : *found;
}

void put_nothing(Writer& /*writer*/, const SlmpForm& /*form*/, const SlmpOperation& /*operation*/)
{
}

std::uint16_t take_nothing(Reader& /*reader*/, const SlmpForm& /*form*/,
                           SlmpOperation& /*operation*/)
{
    return 0;
}

void encode_nothing(Writer& /*writer*/, const SlmpOperation& /*operation*/,
                    const SlmpAnswer& /*answer*/)
{
}

void decode_nothing(Reader& /*reader*/, const SlmpOperation& /*operation*/, SlmpAnswer& /*answer*/)
{
}

} // namespace detail

namespace {

using detail::SlmpCommandCodec;
using detail::SlmpForm;

constexpr std::size_t request_fields = 6;
constexpr std::size_t error_size = 9;

SlmpForm form_of(const SlmpOperation& operation, const SlmpCommandCodec& codec)
{
    const auto is_elsewhere = [](const SlmpBlock& block) {
        return block.device.direct_memory != 0;
    };
    return codec.has_devices
               ? SlmpForm{operation.is_bits, operation.has_long_form,
                          std::ranges::any_of(operation.blocks, is_elsewhere) ||
                              std::ranges::any_of(operation.more_blocks, is_elsewhere)}
               : SlmpForm{};
}

void put_station(binary::Writer& writer, const SlmpStation& station)
{
    writer.number(station.network);
    writer.number(station.station);
    writer.number(station.module);
    writer.number(station.multidrop);
}

SlmpStation take_station(binary::Reader& reader)
{
    SlmpStation station;
    station.network = reader.number<std::uint8_t>();
    station.station = reader.number<std::uint8_t>();
    station.module = reader.number<std::uint16_t>();
    station.multidrop = reader.number<std::uint8_t>();
    return station;
}

/// Returns a frame with what `write` writes after the head.
template <typename Write>
Result<std::vector<std::byte>> make_frame(const SlmpHead& head, bool is_response, Write write)
{
    binary::VectorSink body_sink{UINT16_MAX};
    binary::Writer body{body_sink};
    write(body);
    if (!body.ok()) {
        return fail(body.status() == StatusCode{status::Bad_EncodingLimitsExceeded}
                        ? StatusCode{status::Bad_RequestTooLarge}
                        : body.status());
    }
    const std::size_t size = body.written();
    binary::VectorSink sink;
    binary::Writer writer{sink};
    const bool has_serial = head.frame == SlmpFrame::Frame4E;
    writer.number(
        static_cast<std::uint16_t>((is_response ? 0xD0U : 0x50U) | (has_serial ? 4U : 0U)));
    if (has_serial) {
        writer.number(head.serial);
        writer.number(std::uint16_t{0});
    }
    put_station(writer, head.station);
    writer.number(static_cast<std::uint16_t>(size));
    writer.bytes(body_sink.take(size));
    return sink.take(writer.written());
}

} // namespace

std::uint16_t slmp_subcommand(const SlmpOperation& operation)
{
    const auto* const codec =
        detail::find_slmp_command(static_cast<std::uint16_t>(operation.command));
    return codec == nullptr ? std::uint16_t{0} : form_of(operation, *codec).subcommand();
}

Result<std::optional<SlmpHead>> read_slmp_head(std::span<const std::byte> bytes)
{
    constexpr unsigned response_bit = 0x80;
    constexpr unsigned serial_bit = 0x04;
    if (bytes.empty()) {
        return std::nullopt;
    }
    const auto first = std::to_integer<unsigned>(bytes[0]);
    if ((first & ~(response_bit | serial_bit)) != 0x50U ||
        (bytes.size() > 1 && bytes[1] != std::byte{0})) {
        return fail(status::Bad_DecodingError);
    }
    SlmpHead head;
    head.frame = (first & serial_bit) != 0 ? SlmpFrame::Frame4E : SlmpFrame::Frame3E;
    head.is_response = (first & response_bit) != 0;
    head.head_size = head.frame == SlmpFrame::Frame4E ? 13 : 9;
    if (bytes.size() < head.head_size) {
        return std::nullopt;
    }
    binary::Reader reader{bytes};
    reader.skip(2);
    if (head.frame == SlmpFrame::Frame4E) {
        head.serial = reader.number<std::uint16_t>();
        // PLCs return what they were sent here.
        reader.skip(2);
    }
    head.station = take_station(reader);
    const std::size_t size = reader.number<std::uint16_t>();
    if (size < (head.is_response ? 2 : request_fields)) {
        return fail(status::Bad_DecodingError);
    }
    head.size = head.head_size + size;
    return head;
}

Result<std::vector<std::byte>> encode_slmp_request(const SlmpHead& head, std::uint16_t timer,
                                                   const SlmpOperation& operation)
{
    const auto command = static_cast<std::uint16_t>(operation.command);
    const auto* const codec = detail::find_slmp_command(command);
    if (codec == nullptr || (operation.is_bits && !codec->may_have_bits)) {
        return fail(status::Bad_InvalidArgument);
    }
    return make_frame(head, false, [&](binary::Writer& writer) {
        const SlmpForm form = form_of(operation, *codec);
        writer.number(timer);
        writer.number(command);
        writer.number(form.subcommand());
        codec->encode_request(writer, form, operation);
    });
}

Result<SlmpRequestBody> read_slmp_request(const SlmpHead& head, std::span<const std::byte> frame)
{
    binary::Reader reader{frame};
    reader.skip(head.head_size);
    SlmpRequestBody body;
    body.timer = reader.number<std::uint16_t>();
    body.command = reader.number<std::uint16_t>();
    body.subcommand = reader.number<std::uint16_t>();
    body.data = reader.bytes(reader.remaining());
    if (!reader.ok() || head.is_response || frame.size() != head.size) {
        return fail(status::Bad_DecodingError);
    }
    return body;
}

Expected<SlmpOperation, std::uint16_t> decode_slmp_request(const SlmpRequestBody& body)
{
    using Refused = Unexpected<std::uint16_t>;
    const auto* const codec = detail::find_slmp_command(body.command);
    const auto form = SlmpForm::of(body.subcommand);
    if (codec == nullptr || !form || (!codec->has_devices && body.subcommand != 0) ||
        (form->is_bits && !codec->may_have_bits)) {
        return Refused{detail::end_code_command};
    }
    SlmpOperation operation;
    operation.command = codec->command;
    operation.is_bits = form->is_bits;
    operation.has_long_form = form->is_long;
    binary::Reader reader{body.data};
    const std::uint16_t end_code = codec->decode_request(reader, *form, operation);
    if (!reader.ok() || (end_code == 0 && reader.remaining() != 0)) {
        return Refused{detail::end_code_length};
    }
    if (end_code != 0) {
        return Refused{end_code};
    }
    return operation;
}

Result<std::vector<std::byte>> encode_slmp_answer(const SlmpHead& request,
                                                  const SlmpOperation& operation,
                                                  const SlmpAnswer& answer)
{
    const auto* const codec =
        detail::find_slmp_command(static_cast<std::uint16_t>(operation.command));
    return make_frame(request, true, [&](binary::Writer& writer) {
        writer.number(answer.end_code);
        if (answer.end_code == 0 && codec != nullptr) {
            codec->encode_answer(writer, operation, answer);
        } else if (answer.error) {
            put_station(writer, answer.error->station);
            writer.number(answer.error->command);
            writer.number(answer.error->subcommand);
        }
    });
}

Result<SlmpAnswer> decode_slmp_answer(const SlmpOperation& operation, const SlmpHead& head,
                                      std::span<const std::byte> frame)
{
    const auto* const codec =
        detail::find_slmp_command(static_cast<std::uint16_t>(operation.command));
    if (codec == nullptr || !head.is_response || frame.size() != head.size) {
        return fail(status::Bad_DecodingError);
    }
    binary::Reader reader{frame};
    reader.skip(head.head_size);
    SlmpAnswer answer;
    answer.end_code = reader.number<std::uint16_t>();
    if (answer.end_code == 0) {
        codec->decode_answer(reader, operation, answer);
    } else if (reader.remaining() >= error_size) {
        SlmpErrorInformation& error = answer.error.emplace();
        error.station = take_station(reader);
        error.command = reader.number<std::uint16_t>();
        error.subcommand = reader.number<std::uint16_t>();
    }
    if (!reader.ok() || reader.remaining() != 0) {
        return fail(status::Bad_DecodingError);
    }
    return answer;
}

} // namespace busbar::backend
