#pragma once

#include <cstdint>
#include <string_view>

#include <busbar/core/api.hpp>

namespace busbar::channel {

/// Where the symmetric keys of channels go, so that a test bench can decrypt what it captured.
/// Whoever has them can read, and forge, all that the channels carry. Used only by builds with the
/// option BUSBAR_KEY_LOG, which products do not have; and there nothing is written unless
/// ChannelEnvironment names it.
class BUSBAR_API KeyLog {
public:
    KeyLog() = default;
    KeyLog(const KeyLog&) = delete;
    KeyLog& operator=(const KeyLog&) = delete;
    virtual ~KeyLog() = default;

    /// The six lines of one SecurityToken, when its keys are made and before they are used:
    ///
    ///     client_iv_<SecureChannelId>_<TokenId>: <hexadecimal>
    ///     client_key_<SecureChannelId>_<TokenId>: <hexadecimal>
    ///     client_siglen_<SecureChannelId>_<TokenId>: <bytes of a signature>
    ///
    /// and the same with "server". It is what the OPC UA dissector of Wireshark 4.4 and later reads
    /// from the file of its preference opcua.debug_file. Any thread; must not block for long.
    virtual void write(std::string_view lines) = 0;
};

} // namespace busbar::channel
