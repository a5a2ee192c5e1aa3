#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/backend/slmp_message.hpp>
#include <busbar/binary/reader.hpp>
#include <busbar/binary/writer.hpp>

namespace busbar::backend::detail {

inline constexpr std::uint16_t end_code_command = 0xC059;
inline constexpr std::uint16_t end_code_content = 0xC05C;
inline constexpr std::uint16_t end_code_bits = 0xC060;
inline constexpr std::uint16_t end_code_length = 0xC061;

/// A subcommand: bit 0 bits instead of words, bit 1 long form, bit 7 devices with extension.
struct SlmpForm {
    bool is_bits{false};
    bool is_long{false};
    bool is_extended{false};

    [[nodiscard]] static std::optional<SlmpForm> of(std::uint16_t subcommand);
    [[nodiscard]] std::uint16_t subcommand() const;
};

/// A decoder of a request: reads the data into the operation, of which command and form are set.
/// Returns an end code, 0 if the content is right; a failed reader means a wrong length.
using DecodeSlmpRequest = std::uint16_t (*)(binary::Reader&, const SlmpForm&, SlmpOperation&);
/// An encoder of a request; fails the writer with Bad_InvalidArgument if it is not possible.
using EncodeSlmpRequest = void (*)(binary::Writer&, const SlmpForm&, const SlmpOperation&);
/// A decoder of the answer's data, which fails the reader if it does not fit the operation.
using DecodeSlmpAnswer = void (*)(binary::Reader&, const SlmpOperation&, SlmpAnswer&);
/// An encoder of the answer's data.
using EncodeSlmpAnswer = void (*)(binary::Writer&, const SlmpOperation&, const SlmpAnswer&);

/// One command in both directions.
struct SlmpCommandCodec {
    SlmpCommand command;
    /// It has devices, and so each form; else the subcommand is 0.
    bool has_devices;
    /// It may be in bits.
    bool may_have_bits;
    EncodeSlmpRequest encode_request;
    DecodeSlmpRequest decode_request;
    EncodeSlmpAnswer encode_answer;
    DecodeSlmpAnswer decode_answer;
};

/// Null for an unknown command.
[[nodiscard]] const SlmpCommandCodec* find_slmp_command(std::uint16_t command);

/// The commands with devices.
extern const SlmpCommandCodec batch_read;
extern const SlmpCommandCodec batch_write;
extern const SlmpCommandCodec random_read;
extern const SlmpCommandCodec random_write;
extern const SlmpCommandCodec register_monitor;
extern const SlmpCommandCodec read_monitor;
extern const SlmpCommandCodec block_read;
extern const SlmpCommandCodec block_write;
/// The commands with labels.
extern const SlmpCommandCodec label_array_read;
extern const SlmpCommandCodec label_array_write;
extern const SlmpCommandCodec label_random_read;
extern const SlmpCommandCodec label_random_write;

/// For requests without data.
void put_nothing(binary::Writer& writer, const SlmpForm& form, const SlmpOperation& operation);
std::uint16_t take_nothing(binary::Reader& reader, const SlmpForm& form, SlmpOperation& operation);
/// For answers without data.
void encode_nothing(binary::Writer& writer, const SlmpOperation& operation,
                    const SlmpAnswer& answer);
void decode_nothing(binary::Reader& reader, const SlmpOperation& operation, SlmpAnswer& answer);

/// Writes text as UTF-16, low byte first, after its length in units of it. False if it is not
/// UTF-8, or too long.
[[nodiscard]] bool write_utf16(binary::Writer& writer, std::string_view text);
/// Reads such a text. Nothing if it is too short or has half a character.
[[nodiscard]] std::optional<std::string> read_utf16(binary::Reader& reader);

} // namespace busbar::backend::detail
