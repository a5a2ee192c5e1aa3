#include <cstdint>

#include "crypto/certificate_checks.hpp"
#include "fuzz_root.hpp"

namespace crl_fuzz {

using namespace busbar;
using namespace busbar::crypto;

/// A file that an administrator, or somebody else, put among the revocation lists.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const auto list = RevocationList::parse_file(std::as_bytes(std::span{data, size}));
    if (!list) {
        return 0;
    }
    const Certificate& root = test::fuzz_root();
    static_cast<void>(list->issuer());
    static_cast<void>(list->revoked_at(root));
    if (!RevocationList::parse(list->der()) || list->size() > size) {
        __builtin_trap();
    }
    const CertificateChain path{root, root};
    const TrustList known{{root}, {}, {*list}, {*list}};
    const ValidationContext context{nullptr, test::fuzz_time, {}};
    crypto::detail::SignatureChecks signatures;
    const crypto::detail::Validation validation{path, known, context, signatures};
    static_cast<void>(crypto::detail::find_revocation_list(validation, 0));
    static_cast<void>(crypto::detail::check_revocation(validation, 0));
    return 0;
}

} // namespace crl_fuzz
