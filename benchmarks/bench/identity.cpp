#include "identity.hpp"

#include <utility>

#include <busbar/crypto/self_signed.hpp>

namespace busbar::bench {

Result<channel::ApplicationIdentity> make_identity(DateTime now, std::uint32_t key_bits)
{
    auto key = crypto::PrivateKey::generate(key_bits);
    if (!key) {
        return fail(key.error());
    }
    crypto::CertificateSubject subject;
    subject.common_name = "Busbar bench";
    subject.application_uri = "urn:busbar:bench";
    subject.dns_names = {"localhost"};
    subject.valid_from = DateTime{now.ticks - 3'600 * DateTime::ticks_per_second};
    subject.valid_days = 1;
    auto certificate = crypto::create_self_signed(*key, subject);
    if (!certificate) {
        return fail(certificate.error());
    }
    return channel::ApplicationIdentity{{*std::move(certificate)}, *std::move(key)};
}

} // namespace busbar::bench
