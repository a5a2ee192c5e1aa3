#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/log.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/types/session.hpp>

#include "proxy_endpoints.hpp"

namespace busbar::harness::detail {

/// A password or issued token on its way past the connection in between.
struct ProxySecret {
    /// The way in which the client has encrypted it (Part 4, 7.40.2).
    enum class Form : std::uint8_t { Plain, Legacy, Sealed };
    Form form{Form::Plain};
    /// Null for Plain.
    const crypto::SecurityPolicy* policy{nullptr};
    crypto::Secret text;
};

/// Explains in the log why a message is not passed on, and returns the status.
[[nodiscard]] Result<void> refuse_message(LogSink& log, StatusCode status, std::string_view check,
                                          std::string found, std::string_view rule,
                                          std::string remedy);

/// Takes the secrets out of user tokens, and encrypts them again for the server.
class ProxySecrets {
public:
    /// All must outlive it.
    ProxySecrets(const ProxyEndpoints& endpoints, const WallClock& clock, LogSink& log)
        : endpoints_{&endpoints}, clock_{&clock}, log_{&log}
    {
    }

    /// Takes the secret out of a client's token; nothing if it has none. `nonce` is the server's
    /// last one. Refuses tokens that cannot be passed on, or that may have a secret elsewhere.
    [[nodiscard]] Result<std::optional<ProxySecret>> take(const channel::SecuritySetting& security,
                                                          const ByteString& nonce,
                                                          ExtensionObject& token) const;
    /// Puts it into a token for the server with this certificate, as the client had encrypted it.
    [[nodiscard]] Result<void> put(const ProxySecret& secret, const crypto::Certificate* server,
                                   const ByteString& nonce, ExtensionObject& token) const;

private:
    [[nodiscard]] Result<ProxySecret> open(const channel::SecuritySetting& security,
                                           const ByteString& nonce, const String& policy_id,
                                           const ByteString& data, const String& algorithm) const;

    const ProxyEndpoints* endpoints_;
    const WallClock* clock_;
    LogSink* log_;
};

} // namespace busbar::harness::detail
