#include <cstdint>
#include <string>

#include <busbar/crypto/certificate_store.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/crypto/signing_request.hpp>

#include "fuzz_script.hpp"

namespace certificate_names_fuzz {

using namespace busbar;
using namespace busbar::crypto;

namespace {

const PrivateKey& key()
{
    static const PrivateKey made = *PrivateKey::generate(2'048);
    return made;
}

std::string text(fuzz::Script& script)
{
    const auto bytes = script.bytes(script.byte() % 80U);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void require(bool condition)
{
    if (!condition) {
        __builtin_trap();
    }
}

} // namespace

/// Any names for a certificate and a request of one: they are refused, or stand in it as they are.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    CertificateSubject subject;
    subject.common_name = text(script);
    subject.organization = text(script);
    subject.organizational_unit = text(script);
    subject.locality = text(script);
    subject.state = text(script);
    subject.country = text(script);
    subject.application_uri = text(script);
    add_host(subject, text(script));
    add_host(subject, text(script));
    subject.valid_from = DateTime::from_unix_seconds(script.byte() * 40'000'000LL);
    subject.valid_days = script.byte() * 100U;
    const auto made = create_self_signed(key(), subject);
    if (made) {
        const CertificateSubject again = subject_of(*made);
        require(again.common_name == subject.common_name);
        require(again.organization == subject.organization);
        require(again.application_uri == subject.application_uri);
        require(again.dns_names == subject.dns_names);
        require(!certificate_text(*made).empty());
    }
    // The validity is the CA's.
    if (!create_signing_request(key(), subject)) {
        require(!made);
    }
    return 0;
}

} // namespace certificate_names_fuzz
