#pragma once

#include <functional>

#include <busbar/core/problem.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/server/server.hpp>

#include "node_table.hpp"

namespace busbar::administration::detail {

/// What the server's own certificate says, as the Object "OwnCertificate" below
/// ServerConfiguration, in the server's namespace: W588, 3-2-5 lists these. With the access of
/// ServerConfiguration's Properties. ConfiguredSubject and ConfiguredHosts are what `configured`
/// says (see ManagedCertificates); without it they are not there.
[[nodiscard]] Configured<void>
add_own_certificate(server::Server& server, NodeTable& table,
                    const std::function<crypto::CertificateSubject()>& configured);

} // namespace busbar::administration::detail
