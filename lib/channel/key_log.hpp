#pragma once

#include <cstdint>

#include <busbar/channel/channel_types.hpp>

#include "conversation.hpp"
#include "token.hpp"

namespace busbar::channel::detail {

/// Which SecurityToken, and what its keys are made of.
struct LoggedToken {
    std::uint32_t channel_id;
    std::uint32_t token_id;
    const SecuritySetting& security;
    Nonces nonces; // as make_token has them
};

#ifdef BUSBAR_KEY_LOG
/// Hands the keys of a token to `log`, which may be null. Nothing with mode None.
void log_keys(KeyLog* log, Role role, const LoggedToken& token);
#endif

} // namespace busbar::channel::detail
