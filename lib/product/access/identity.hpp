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

/// What file, project and administrators say of names and hosts in the certificate; the names are
/// empty where nobody has said other ones than the controller has by itself.
[[nodiscard]] crypto::CertificateSubject configured_subject(const ControllerConfig& config);

} // namespace busbar::product
