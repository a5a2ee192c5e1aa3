#include "token.hpp"

namespace busbar::channel::detail {

namespace {

/// Part 6, 6.7.2.4: a number starts again, below `wrapped_below`, when it is greater than this.
constexpr std::uint32_t wraps_after = UINT32_MAX - 1024;
constexpr std::uint32_t wrapped_below = 1024;

} // namespace

Result<Token> make_token(std::uint32_t id, const SecuritySetting& setting, const Nonces& nonces,
                         std::chrono::milliseconds lifetime, TimePoint now)
{
    Token token;
    token.id = id;
    token.renew_at = now + lifetime * 3 / 4;
    token.ends_at = now + lifetime;
    token.expires_at = now + lifetime * 5 / 4;
    if (setting.mode == MessageSecurityMode::None) {
        return token;
    }
    const auto send_keys = crypto::derive_keys(*setting.policy, nonces.peer, nonces.own);
    const auto receive_keys = crypto::derive_keys(*setting.policy, nonces.own, nonces.peer);
    if (!send_keys || !receive_keys) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    auto send = crypto::SymmetricCipher::create(*setting.policy, *send_keys);
    auto receive = crypto::SymmetricCipher::create(*setting.policy, *receive_keys);
    if (!send || !receive) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    token.send = *std::move(send);
    token.receive = *std::move(receive);
    return token;
}

std::uint32_t SequenceNumbers::next()
{
    last_ = last_ > wraps_after ? 1 : last_ + 1;
    return last_;
}

bool SequenceNumbers::accept(std::uint32_t number)
{
    const bool follows = has_begun_ && number == last_ + 1 && number != 0;
    // Some stacks wrap one number too early, which does no harm.
    const bool wraps = has_begun_ && last_ >= wraps_after && number < wrapped_below;
    if (has_begun_ && !follows && !wraps) {
        return false;
    }
    has_begun_ = true;
    last_ = number;
    return true;
}

} // namespace busbar::channel::detail
