#include <cstdint>
#include <cstdlib>
#include <span>

#include <busbar/crypto/certificate_validator.hpp>

#include "administration/trust_list_file.hpp"
#include "support/identity.hpp"

namespace trust_list_fuzz {

using namespace busbar;
using namespace busbar::administration::detail;

namespace {

const crypto::TrustList& present()
{
    static const crypto::TrustList list = [] {
        crypto::TrustList made;
        made.trusted = test::client_identity().certificates;
        return made;
    }();
    return list;
}

} // namespace

/// The file of a TrustList as a client wrote it (Part 12, 7.8.2.5): what is taken from it is
/// checked, written again and read again the same.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    crypto::TrustListParts parts;
    const auto list = merge(std::as_bytes(std::span{data, size}), present(), parts);
    if (!list) {
        return 0;
    }
    static_cast<void>(
        crypto::check_trust_list(*list, test::today, crypto::CertificatePurpose::Application));
    const auto bytes = bytes_of(*list, all_lists);
    crypto::TrustListParts again;
    const auto same = merge(bytes, {}, again);
    if (!same || bytes_of(*same, all_lists) != bytes || !again.trusted || !again.issuer_crls) {
        std::abort();
    }
    return 0;
}

} // namespace trust_list_fuzz
