#pragma once

#include <string>
#include <vector>

#include <busbar/channel/channel_types.hpp>

#include "config.hpp"

namespace busbar::example {

/// The controller's certificate and key from the configured folder's own list (see
/// crypto::OwnCertificateStore), made there if they are missing. Throws ConfigError.
[[nodiscard]] channel::ApplicationIdentity load_identity(const CertificateConfig& config,
                                                         const std::string& name,
                                                         const std::string& application_uri,
                                                         const std::vector<std::string>& host_names,
                                                         DateTime now);

} // namespace busbar::example
