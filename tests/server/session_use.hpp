#pragma once

#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

#include "support/server_fixture.hpp"

namespace busbar::test {

inline const channel::SecuritySetting sign = setting("Basic256Sha256", MessageSecurityMode::Sign);
inline const channel::SecuritySetting encrypt =
    setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);

[[nodiscard]] inline ReadRequest read_state()
{
    ReadRequest request;
    request.nodes_to_read.resize(1);
    request.nodes_to_read[0].node_id = NodeId{0, id::Server_ServerStatus_State};
    request.nodes_to_read[0].attribute_id = 13;
    return request;
}

/// What a Read in the client's session answers.
[[nodiscard]] inline StatusCode use(TestClient& client)
{
    return client.status_of<ReadResponse>(read_state());
}

} // namespace busbar::test
