#pragma once

#include <cstring>
#include <string>
#include <vector>

#include <busbar/types/session.hpp>

#include "support/login.hpp"

namespace busbar::test {

/// CreateSession of a simulated client.
[[nodiscard]] inline CreateSessionRequest session_request(bool is_secure)
{
    CreateSessionRequest request;
    request.client_description.application_uri = "urn:busbar:test:client";
    request.client_description.application_type = ApplicationType::Client;
    request.endpoint_url = "opc.tcp://localhost:4840";
    request.session_name = "simulated";
    static std::uint64_t sessions = 0; // each has a nonce of its own
    ++sessions;
    std::vector<std::byte> nonce(32);
    std::memcpy(nonce.data(), &sessions, sizeof sessions);
    request.client_nonce = ByteString{std::move(nonce)};
    if (is_secure) {
        request.client_certificate = ByteString{client_identity().certificates.front().der()};
    }
    return request;
}

/// ActivateSession of a user with a password.
[[nodiscard]] inline ActivateSessionRequest activation_request(const crypto::SecurityPolicy& policy,
                                                               const std::string& name,
                                                               const std::string& password,
                                                               const ByteString& server_nonce)
{
    ActivateSessionRequest request;
    request.client_signature = sign_session(policy, client_identity(), server_nonce);
    request.user_identity_token = user_token(policy, name, password, server_nonce);
    return request;
}

} // namespace busbar::test
