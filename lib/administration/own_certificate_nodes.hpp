#pragma once

#include <functional>

#include <busbar/core/problem.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/server/server.hpp>

#include "node_table.hpp"

namespace busbar::administration::detail {

/// Shows the server's own certificate as the Object "OwnCertificate" below ServerConfiguration, in
/// the server's namespace, with the facts that W588, 3-2-5 lists. It has the access rights of
/// ServerConfiguration's Properties. ConfiguredSubject and ConfiguredHosts have the values of
/// `configured` (see ManagedCertificates); without that they do not exist.
[[nodiscard]] Configured<void>
add_own_certificate(server::Server& server, NodeTable& table,
                    const std::function<crypto::CertificateSubject()>& configured);

} // namespace busbar::administration::detail
