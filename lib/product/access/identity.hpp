#pragma once

#include <string>
#include <vector>

#include <busbar/channel/channel_types.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// Loads the controller's certificate and key from the own list of the configured folder (see
/// crypto::OwnCertificateStore). Creates them if they are missing, and tells `log`. Throws
/// ConfigError.
[[nodiscard]] channel::ApplicationIdentity load_identity(const CertificateConfig& config,
                                                         const std::string& name,
                                                         const std::string& application_uri,
                                                         const std::vector<std::string>& host_names,
                                                         DateTime now, LogSink& log);
/// Creates a new certificate with a new key, and moves the old ones to own/replaced. Clients must
/// trust the new certificate. Throws ConfigError.
[[nodiscard]] crypto::Certificate regenerate_certificate(const CertificateConfig& config,
                                                         const std::string& name,
                                                         const std::string& application_uri,
                                                         const std::vector<std::string>& host_names,
                                                         DateTime now);

/// The names for the certificate from file, project and administrators, empty where the controller
/// uses its own, and the hosts by which clients reach it now.
[[nodiscard]] crypto::CertificateSubject configured_subject(const ControllerConfig& config);

} // namespace busbar::product
