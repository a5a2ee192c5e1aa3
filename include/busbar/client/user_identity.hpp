#pragma once

#include <memory>
#include <string>
#include <variant>

#include <busbar/core/types.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/private_key.hpp>

namespace busbar::client {

/// The user of a session (Part 4, 7.40).
struct AnonymousUser {};
/// A user with a password (Part 4, 7.40.4).
struct NamedUser {
    std::string user_name;
    std::string password;
};
/// An X.509 certificate and its key; the certificate is sent as it is.
struct CertificateUser {
    crypto::Certificate certificate;
    std::shared_ptr<const crypto::PrivateKey> key;
};
/// A token that another party issued, such as a JWT (Part 6, 6.5.2).
struct IssuedUser {
    std::string token;
    /// IssuedTokenType of the token policy; the default is JWT.
    std::string type_uri{"http://opcfoundation.org/UA/UserToken#JWT"};
};

/// One of the ways to log in.
using UserIdentity = std::variant<AnonymousUser, NamedUser, CertificateUser, IssuedUser>;

} // namespace busbar::client
