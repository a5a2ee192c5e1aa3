#pragma once

#include <cstdint>
#include <string_view>

#include <busbar/core/api.hpp>

namespace busbar::channel {

/// Receives the symmetric keys of channels, so that a test bench can decrypt captured traffic. With
/// these keys everything that the channels carry can be read and forged. Used only by builds with
/// the option BUSBAR_KEY_LOG, which products do not set; and even there nothing is written unless
/// ChannelEnvironment names a KeyLog.
class BUSBAR_API KeyLog {
public:
    KeyLog() = default;
    KeyLog(const KeyLog&) = delete;
    KeyLog& operator=(const KeyLog&) = delete;
    virtual ~KeyLog() = default;

    /// Writes the six lines of one SecurityToken, when its keys are derived and before they are
    /// used:
    ///
    ///     client_iv_<SecureChannelId>_<TokenId>: <hexadecimal>
    ///     client_key_<SecureChannelId>_<TokenId>: <hexadecimal>
    ///     client_siglen_<SecureChannelId>_<TokenId>: <bytes of a signature>
    ///
    /// and the same with "server". The OPC UA dissector of Wireshark 4.4 and later reads them from
    /// the file of its preference opcua.debug_file. Called from any thread; must not block for
    /// long.
    virtual void write(std::string_view lines) = 0;
};

} // namespace busbar::channel
