#include "symmetric_chunk.hpp"

#include <algorithm>

#include <busbar/binary/reader.hpp>

#include "refusals.hpp"

namespace busbar::channel::detail {

namespace {

constexpr std::size_t body_offset = symmetric_header_size + sequence_header_size;

std::size_t signature_size(const SecuritySetting& setting)
{
    return setting.mode == MessageSecurityMode::None ? 0 : setting.policy->symmetric_signature_size;
}

/// Part 6, 6.7.2.5: returns the maximum size of a body in a chunk of `size` bytes.
std::size_t max_body_size(std::size_t size, const SecuritySetting& setting)
{
    const std::size_t block = is_encrypted(setting) ? setting.policy->block_size : 1;
    const std::size_t padding_field = is_encrypted(setting) ? 1 : 0;
    const std::size_t secured = (size - symmetric_header_size) / block * block;
    return secured - sequence_header_size - padding_field - signature_size(setting);
}

/// Returns the content without its signature and padding. The signature is checked before the
/// padding.
Result<std::span<const std::byte>> unwrap(std::span<std::byte> chunk,
                                          const SecuritySetting& setting, Token& token)
{
    const std::size_t signature = signature_size(setting);
    if (chunk.size() < body_offset + signature) {
        return security_failure();
    }
    if (is_encrypted(setting) && !token.receive->decrypt(chunk.subspan(symmetric_header_size))) {
        return security_failure();
    }
    const auto content = chunk.first(chunk.size() - signature);
    if (signature != 0 && !token.receive->verify(content, chunk.last(signature))) {
        return security_failure();
    }
    if (!is_encrypted(setting)) {
        return content;
    }
    const std::size_t padding = std::to_integer<std::size_t>(content.back()) + 1;
    if (padding > content.size() - body_offset) {
        return security_failure();
    }
    const auto filler = content.last(padding);
    if (!std::all_of(filler.begin(), filler.end(), [&](std::byte b) { return b == filler[0]; })) {
        return security_failure();
    }
    return content.first(content.size() - padding);
}

} // namespace

bool is_encrypted(const SecuritySetting& setting)
{
    return setting.mode == MessageSecurityMode::SignAndEncrypt;
}

Result<SymmetricHeader> parse_symmetric_header(std::span<const std::byte> chunk)
{
    binary::Reader reader{chunk};
    reader.skip(header_size);
    SymmetricHeader header;
    header.channel_id = reader.number<std::uint32_t>();
    header.token_id = reader.number<std::uint32_t>();
    if (!reader.ok()) {
        return security_failure();
    }
    return header;
}

Result<SymmetricContent> open_symmetric(std::span<std::byte> chunk, const SecuritySetting& setting,
                                        Token& token)
{
    const auto content = unwrap(chunk, setting, token);
    if (!content) {
        return fail(content.error());
    }
    binary::Reader reader{*content};
    SymmetricContent result;
    reader.skip(symmetric_header_size);
    result.sequence_number = reader.number<std::uint32_t>();
    result.request_id = reader.number<std::uint32_t>();
    if (!reader.ok()) {
        return security_failure();
    }
    result.body = content->subspan(body_offset);
    return result;
}

ChunkSink::ChunkSink(OutputBuffer& output, Token& token, SequenceNumbers& sequence,
                     const ChunkSettings& settings)
    : output_{&output}, token_{&token}, sequence_{&sequence}, settings_{settings},
      max_body_{max_body_size(settings.max_chunk_size, settings.security)}
{
}

std::span<std::byte> ChunkSink::next()
{
    if (chunks_ != 0 && !seal(chunk_body_, 'C')) {
        return {};
    }
    const std::size_t left = settings_.max_message_size - body_total_;
    if (chunks_ == settings_.max_chunk_count || left == 0) {
        status_ = settings_.too_large;
        return {};
    }
    ++chunks_;
    chunk_ = output_->reserve(settings_.max_chunk_size);
    chunk_body_ = std::min(max_body_, left);
    return chunk_.subspan(body_offset, chunk_body_);
}

bool ChunkSink::finish(std::size_t filled)
{
    if (chunks_ == 0 && next().empty()) { // a message without a body is still a chunk
        return false;
    }
    return seal(filled, 'F');
}

bool ChunkSink::seal(std::size_t body_size, char flag)
{
    const SecuritySetting& security = settings_.security;
    const std::size_t signature = signature_size(security);
    std::size_t end = body_offset + body_size;
    if (is_encrypted(security)) {
        const std::size_t block = security.policy->block_size;
        const std::size_t used = end - symmetric_header_size + 1 + signature;
        const std::size_t padding = (block - used % block) % block;
        std::fill_n(chunk_.begin() + static_cast<std::ptrdiff_t>(end), padding + 1,
                    static_cast<std::byte>(padding));
        end += padding + 1;
    }
    const std::size_t size = end + signature;
    binary::SpanSink sink{chunk_.subspan(header_size, body_offset - header_size)};
    binary::Writer writer{sink};
    write_frame_header(chunk_, {settings_.type, flag, static_cast<std::uint32_t>(size)});
    writer.number(settings_.channel_id);
    writer.number(token_->id);
    writer.number(sequence_->next());
    writer.number(settings_.request_id);
    if (settings_.hook != nullptr) {
        settings_.hook->sealing(chunk_.first(body_offset + body_size));
    }
    const bool is_secured =
        (signature == 0 || token_->send->sign(chunk_.first(end), chunk_.subspan(end, signature))) &&
        (!is_encrypted(security) || token_->send->encrypt(chunk_.subspan(
                                        symmetric_header_size, size - symmetric_header_size)));
    if (!is_secured) {
        status_ = status::Bad_InternalError;
        return false;
    }
    if (settings_.hook != nullptr) {
        settings_.hook->sealed(chunk_.first(size));
    }
    body_total_ += body_size;
    output_->commit(size);
    return true;
}

} // namespace busbar::channel::detail
