#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include <busbar/crypto/symmetric.hpp>
#include <busbar/harness/message_body.hpp>
#include <busbar/harness/recording.hpp>
#include <busbar/types/secure_channel.hpp>

#include "channel/frame.hpp"
#include "chunks.hpp"
#include "dissector.hpp"

namespace busbar::harness {

namespace {

constexpr std::size_t cipher_begin = channel::detail::symmetric_header_size;
constexpr std::size_t clear_begin = cipher_begin + channel::detail::sequence_header_size;
/// The client sends what its keys secure (Part 6, 6.7.5).
struct LoggedKeys {
    crypto::Secret vector;
    crypto::Secret key;
    std::size_t signature_size{0};
    /// Sign alone, which the first chunk shows.
    std::optional<bool> is_clear{};
};
/// SecureChannelId, TokenId and the side that sends.
using TokenPlace = std::tuple<std::uint32_t, std::uint32_t, Side>;

/// Removes the text before the next `end` and that character, and returns the text.
std::string_view part_before(std::string_view& text, char end)
{
    const std::size_t size = text.find(end);
    const std::string_view part = text.substr(0, size);
    text.remove_prefix(size == std::string_view::npos ? text.size() : size + 1);
    return part;
}

std::optional<std::uint32_t> decimal(std::string_view text)
{
    std::uint32_t number = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    return read.ec == std::errc{} && read.ptr == text.data() + text.size() ? std::optional{number}
                                                                           : std::nullopt;
}

/// Empty if the text is not hexadecimal, or longer than any key.
crypto::Secret hexadecimal(std::string_view text)
{
    constexpr std::size_t max_key = 32;
    crypto::Secret bytes{text.size() / 2};
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::uint8_t byte = 0;
        const char* const digits = text.data() + 2 * i;
        const auto read = std::from_chars(digits, digits + 2, byte, 16);
        if (read.ec != std::errc{} || read.ptr != digits + 2) {
            return {};
        }
        bytes.span()[i] = std::byte{byte};
    }
    return text.size() % 2 == 0 && bytes.size() <= max_key ? std::move(bytes) : crypto::Secret{};
}

/// "client_key_7_1: 00FF"; other lines say nothing.
std::map<TokenPlace, LoggedKeys> keys_in(std::string_view key_log)
{
    std::map<TokenPlace, LoggedKeys> all;
    while (!key_log.empty()) {
        std::string_view value = part_before(key_log, '\n');
        std::string_view name = part_before(value, ':');
        value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
        value = value.substr(0, value.find_last_not_of(" \r") + 1);
        const std::string_view end = part_before(name, '_');
        const std::string_view kind = part_before(name, '_');
        const auto channel_id = decimal(part_before(name, '_'));
        const auto token_id = decimal(name);
        if ((end != "client" && end != "server") || !channel_id || !token_id) {
            continue;
        }
        LoggedKeys& keys =
            all[{*channel_id, *token_id, end == "client" ? Side::Client : Side::Server}];
        if (kind == "iv") {
            keys.vector = hexadecimal(value);
        } else if (kind == "key") {
            keys.key = hexadecimal(value);
        } else if (kind == "siglen") {
            keys.signature_size = decimal(value).value_or(0);
        }
    }
    return all;
}

/// Decrypts the connections of one recording.
class Decryption {
public:
    explicit Decryption(std::string_view key_log) : keys_{keys_in(key_log)} {}

    /// Takes the bytes of an entry, and returns what they complete; nothing if something in them
    /// cannot be decrypted.
    [[nodiscard]] std::optional<std::vector<std::byte>> feed(const Recording::Entry& entry)
    {
        detail::Dissector& dissector = dissectors_[entry.connection];
        dissector.feed(entry.from, entry.bytes);
        std::vector<std::byte> plain;
        while (const auto frame = dissector.take(entry.from)) {
            auto bytes = open(entry.from, *frame);
            if (!bytes) {
                return std::nullopt;
            }
            plain.insert(plain.end(), bytes->begin(), bytes->end());
        }
        return plain;
    }

private:
    [[nodiscard]] std::optional<std::vector<std::byte>> open(Side from,
                                                             const detail::DissectedFrame& frame)
    {
        const bool is_secured =
            !frame.is_plain &&
            (frame.type_name == "OPN" || frame.type_name == "MSG" || frame.type_name == "CLO");
        if (!is_secured) {
            return frame.bytes;
        }
        if (frame.type_name == "OPN") {
            return frame.bytes.size() < 12 ? std::nullopt : open_channel(from, frame.bytes);
        }
        return open_chunk(from, frame);
    }
    static std::optional<std::vector<std::byte>> open_channel(Side from,
                                                              std::span<const std::byte> secured);
    [[nodiscard]] std::optional<std::vector<std::byte>>
    open_chunk(Side from, const detail::DissectedFrame& frame);
    /// The sequence header and the body of a chunk that was encrypted, or only signed.
    [[nodiscard]] static std::optional<std::vector<std::byte>>
    content_of(std::span<const std::byte> chunk, LoggedKeys& keys);
    [[nodiscard]] static std::optional<std::vector<std::byte>>
    deciphered(std::span<const std::byte> body, const LoggedKeys& keys);

    std::map<TokenPlace, LoggedKeys> keys_;
    std::map<std::uint32_t, detail::Dissector> dissectors_;
};

/// The message that was sent is encrypted for a private key; this one is empty.
std::optional<std::vector<std::byte>> Decryption::open_channel(Side from,
                                                               std::span<const std::byte> secured)
{
    const std::uint32_t channel_id = detail::number_at(secured, detail::channel_offset);
    OpenSecureChannelResponse response;
    response.security_token.channel_id = channel_id;
    const auto body =
        from == Side::Client ? encode_body(OpenSecureChannelRequest{}) : encode_body(response);
    if (!body) {
        return std::nullopt;
    }
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.bytes(std::as_bytes(std::span{"OPNF", 4}));
    writer.number(std::uint32_t{0});
    writer.number(channel_id);
    encode(writer, String{crypto::policy_none().uri});
    encode(writer, ByteString{});
    encode(writer, ByteString{});
    writer.number(std::uint32_t{1});
    writer.number(std::uint32_t{1});
    writer.bytes(*body);
    auto bytes = sink.take(writer.written());
    detail::set_number(bytes, detail::size_offset, static_cast<std::uint32_t>(bytes.size()));
    return bytes;
}

std::optional<std::vector<std::byte>> Decryption::open_chunk(Side from,
                                                             const detail::DissectedFrame& frame)
{
    const std::span<const std::byte> chunk{frame.bytes};
    if (chunk.size() < clear_begin) {
        return std::nullopt;
    }
    const auto found = keys_.find({detail::number_at(chunk, detail::channel_offset),
                                   detail::number_at(chunk, detail::token_offset), from});
    auto content = found == keys_.end() ? std::nullopt : content_of(chunk, found->second);
    if (!content) {
        return std::nullopt;
    }
    std::vector<std::byte> plain{chunk.begin(), chunk.begin() + cipher_begin};
    plain.insert(plain.end(), content->begin(), content->end());
    detail::set_number(plain, detail::size_offset, static_cast<std::uint32_t>(plain.size()));
    return plain;
}

std::optional<std::vector<std::byte>> Decryption::content_of(std::span<const std::byte> chunk,
                                                             LoggedKeys& keys)
{
    const auto body = chunk.subspan(cipher_begin);
    if (body.size() < channel::detail::sequence_header_size + keys.signature_size) {
        return std::nullopt;
    }
    const auto clear = body.first(body.size() - keys.signature_size);
    if (!keys.is_clear) {
        // A first chunk begins with the id of a structure, which a cipher hardly ever does.
        static const binary::TypeRegistry types{binary::namespace0_types()};
        const NodeId id = detail::encoding_of(clear.subspan(channel::detail::sequence_header_size));
        keys.is_clear = types.find(id) != nullptr;
    }
    return *keys.is_clear ? std::vector<std::byte>{clear.begin(), clear.end()}
                          : deciphered(body, keys);
}

std::optional<std::vector<std::byte>> Decryption::deciphered(std::span<const std::byte> body,
                                                             const LoggedKeys& keys)
{
    const auto* const policy = crypto::find_policy_by_name(
        keys.key.size() == 16 ? "Aes128_Sha256_RsaOaep" : "Basic256Sha256");
    if (policy == nullptr || body.size() % policy->block_size != 0) {
        return std::nullopt;
    }
    crypto::SymmetricKeys symmetric;
    symmetric.signing_key = crypto::Secret{policy->signing_key_size}; // nothing is verified
    symmetric.encrypting_key = crypto::Secret{keys.key.span()};
    symmetric.initialization_vector = crypto::Secret{keys.vector.span()};
    auto cipher = crypto::SymmetricCipher::create(*policy, symmetric);
    std::vector<std::byte> content{body.begin(), body.end()};
    if (!cipher || !cipher->decrypt(content)) {
        return std::nullopt;
    }
    content.resize(content.size() - keys.signature_size);
    // Part 6, 6.7.2.5: the size of the padding, and as many bytes with that value.
    const std::size_t padding = std::to_integer<std::size_t>(content.back()) + 1;
    const bool is_padding =
        padding <= content.size() - channel::detail::sequence_header_size &&
        std::all_of(content.end() - static_cast<std::ptrdiff_t>(padding), content.end(),
                    [&](std::byte byte) { return byte == content.back(); });
    if (!is_padding) {
        return std::nullopt;
    }
    content.resize(content.size() - padding);
    return content;
}

} // namespace

Recording decrypted(const Recording& recording, std::string_view key_log)
{
    Decryption decryption{key_log};
    std::map<std::uint32_t, bool> is_closed_to_us;
    std::vector<std::optional<std::vector<std::byte>>> opened(recording.entries.size());
    for (std::size_t i = 0; i < opened.size(); ++i) {
        const Recording::Entry& entry = recording.entries[i];
        if (entry.kind == Recording::Kind::Bytes && !is_closed_to_us[entry.connection]) {
            opened[i] = decryption.feed(entry);
            is_closed_to_us[entry.connection] = !opened[i];
        }
    }
    Recording result;
    result.seed = recording.seed;
    result.is_complete = recording.is_complete;
    for (std::size_t i = 0; i < opened.size(); ++i) {
        Recording::Entry entry = recording.entries[i];
        if (entry.kind == Recording::Kind::Bytes && !is_closed_to_us[entry.connection]) {
            entry.bytes = *std::move(opened[i]);
            if (entry.bytes.empty()) {
                continue; // a frame that a later entry completes
            }
        }
        result.entries.push_back(std::move(entry));
    }
    return result;
}

} // namespace busbar::harness
