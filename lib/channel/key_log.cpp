#include "key_log.hpp"

#include <span>
#include <string>
#include <string_view>

namespace busbar::channel::detail {

namespace {

/// More than the six lines of any policy need, so that a growing text leaves no part of them in
/// freed memory.
constexpr std::size_t max_lines_size = 1'024;

void append_hex(std::string& text, std::span<const std::byte> bytes)
{
    constexpr std::string_view digits = "0123456789ABCDEF";
    for (const std::byte byte : bytes) {
        text += digits[std::to_integer<std::size_t>(byte) >> 4U];
        text += digits[std::to_integer<std::size_t>(byte) & 15U];
    }
}

/// The three lines of one end, "client" or "server".
void append_keys(std::string& text, std::string_view end, const LoggedToken& token,
                 const crypto::SymmetricKeys& keys)
{
    const auto begin_line = [&](std::string_view what) {
        text += end;
        text += what;
        text += std::to_string(token.channel_id) + "_" + std::to_string(token.token_id) + ": ";
    };
    begin_line("_iv_");
    append_hex(text, keys.initialization_vector.span());
    text += '\n';
    begin_line("_key_");
    append_hex(text, keys.encrypting_key.span());
    text += '\n';
    begin_line("_siglen_");
    text += std::to_string(token.security.policy->symmetric_signature_size) + "\n";
}

} // namespace

void log_keys(KeyLog* log, Role role, const LoggedToken& token)
{
    if (log == nullptr || token.security.mode == MessageSecurityMode::None) {
        return;
    }
    const auto [own, peer] = token.nonces;
    const auto send = crypto::derive_keys(*token.security.policy, peer, own);
    const auto receive = crypto::derive_keys(*token.security.policy, own, peer);
    if (!send || !receive) {
        return;
    }
    std::string lines;
    lines.reserve(max_lines_size);
    append_keys(lines, "client", token, role == Role::Client ? *send : *receive);
    append_keys(lines, "server", token, role == Role::Client ? *receive : *send);
    log->write(lines);
    crypto::cleanse(std::as_writable_bytes(std::span{lines}));
}

} // namespace busbar::channel::detail
