#pragma once

#include <cstdint>

#include <busbar/channel/channel_types.hpp>

#include "conversation.hpp"
#include "token.hpp"

namespace busbar::channel::detail {

/// A SecurityToken and the nonces of its keys.
struct LoggedToken {
    std::uint32_t channel_id;
    std::uint32_t token_id;
    const SecuritySetting& security;
    Nonces nonces; // as for make_token
};

#ifdef BUSBAR_KEY_LOG
/// Passes the keys of a token to `log`, which may be null. Does nothing with mode None.
void log_keys(KeyLog* log, Role role, const LoggedToken& token);
#endif

} // namespace busbar::channel::detail
