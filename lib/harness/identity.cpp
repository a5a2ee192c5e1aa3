#include <busbar/harness/identity.hpp>

#include <busbar/crypto/self_signed.hpp>
#include <busbar/harness/report.hpp>

namespace busbar::harness {

Result<channel::ApplicationIdentity> make_identity(const IdentityOptions& options)
{
    auto key = crypto::PrivateKey::generate(options.key_bits);
    if (!key) {
        return fail(key.error());
    }
    crypto::CertificateSubject subject;
    subject.common_name = options.name;
    subject.application_uri = options.application_uri.empty() ? "urn:busbar:harness:" + options.name
                                                              : options.application_uri;
    subject.dns_names = options.host_names;
    if (subject.dns_names.empty()) {
        subject.dns_names = {options.name};
    }
    subject.valid_from = options.valid_from;
    subject.valid_days = options.valid_days;
    auto certificate = crypto::create_self_signed(*key, subject);
    if (!certificate) {
        return fail(certificate.error());
    }
    return channel::ApplicationIdentity{{*std::move(certificate)}, *std::move(key)};
}

const channel::ApplicationIdentity& default_server_identity()
{
    static const channel::ApplicationIdentity identity = need(make_identity({}));
    return identity;
}

const channel::ApplicationIdentity& default_client_identity()
{
    static const channel::ApplicationIdentity identity = [] {
        IdentityOptions options;
        options.name = "client";
        return need(make_identity(options));
    }();
    return identity;
}

} // namespace busbar::harness
