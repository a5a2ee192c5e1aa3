#pragma once

#include <string>

#include <busbar/channel/channel_types.hpp>
#include <busbar/crypto/self_signed.hpp>

namespace busbar::timing {

/// The moment at which everything here takes place.
inline constexpr DateTime now = DateTime::from_unix_seconds(1'767'225'600);

class FixedWallClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override { return timing::now; }
};

/// A new application with a self-signed certificate of a 2048-bit key, which all policies allow.
[[nodiscard]] inline channel::ApplicationIdentity make_identity(const std::string& name)
{
    auto key = crypto::PrivateKey::generate(2'048).value();
    crypto::CertificateSubject subject;
    subject.common_name = name;
    subject.application_uri = "urn:busbar:timing:" + name;
    subject.dns_names = {"localhost"};
    subject.valid_from = now;
    return {{crypto::create_self_signed(key, subject).value()}, key};
}

} // namespace busbar::timing
