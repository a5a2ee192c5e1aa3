#pragma once

#include <string>
#include <vector>

#include <busbar/channel/channel_types.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// The controller's certificate and key from the configured folder's own list (see
/// crypto::OwnCertificateStore), made there if they are missing, of which `log` is told. Throws
/// ConfigError.
[[nodiscard]] channel::ApplicationIdentity load_identity(const CertificateConfig& config,
                                                         const std::string& name,
                                                         const std::string& application_uri,
                                                         const std::vector<std::string>& host_names,
                                                         DateTime now, LogSink& log);
/// A new certificate with a new key instead of what is there, which is kept in own/replaced.
/// Clients have to trust it anew. Throws ConfigError.
[[nodiscard]] crypto::Certificate regenerate_certificate(const CertificateConfig& config,
                                                         const std::string& name,
                                                         const std::string& application_uri,
                                                         const std::vector<std::string>& host_names,
                                                         DateTime now);

/// The names that file, project and administrators want in the certificate, empty where they are
/// those that the controller has by itself, and the hosts by which clients reach it now.
[[nodiscard]] crypto::CertificateSubject configured_subject(const ControllerConfig& config);

} // namespace busbar::product
