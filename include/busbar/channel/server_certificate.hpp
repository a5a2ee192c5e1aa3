#pragma once

#include <string_view>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/refusal.hpp>

namespace busbar::channel {

/// Checks whether a client may accept `chain` as that of the server at `endpoint_url` (Part 4,
/// 6.1.3): the validator of `environment`, which must not be null, decides. The certificate must
/// name the URL's host and, unless that is empty, `server_uri`.
[[nodiscard]] BUSBAR_API Checked<void> validate_server(const ChannelEnvironment& environment,
                                                       const crypto::CertificateChain& chain,
                                                       const crypto::SecurityPolicy& policy,
                                                       std::string_view server_uri,
                                                       std::string_view endpoint_url);

} // namespace busbar::channel
