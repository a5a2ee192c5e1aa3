#include <cstdint>

#include "crypto/certificate_checks.hpp"
#include "fuzz_root.hpp"

namespace certificate_fuzz {

using namespace busbar;
using namespace busbar::crypto;

namespace {

/// No signature can be guessed: the steps behind it are run on whatever was read.
void run_steps(const CertificateChain& chain, const TrustList& list,
               const ValidationContext& context)
{
    crypto::detail::SignatureChecks signatures;
    const crypto::detail::Validation validation{chain, list, context, signatures};
    for (std::size_t i = 0; i < chain.size(); ++i) {
        static_cast<void>(check_certificate(chain[i], context));
        for (const crypto::detail::Check check :
             {crypto::detail::check_structure, crypto::detail::check_policy,
              crypto::detail::check_host_name, crypto::detail::check_uri,
              crypto::detail::check_usage, crypto::detail::check_issuer_usage}) {
            static_cast<void>(check(validation, i));
        }
    }
}

} // namespace

/// The first byte chooses what is asked; the rest is the chain that a peer sends.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    if (size == 0) {
        return 0;
    }
    const auto chain = parse_chain(std::as_bytes(std::span{data, size}).subspan(1));
    if (!chain) {
        return 0;
    }
    const std::uint8_t choice = data[0];
    ValidationContext context{find_policy_by_name("Basic256Sha256"), test::fuzz_time, "urn:a",
                              "plc.example", static_cast<CertificatePurpose>(choice & 3U)};
    context.application_uri = (choice & 4U) != 0 ? "urn:test:leaf" : "";
    context.host_name = (choice & 8U) != 0 ? "192.0.2.7" : "plc.example";
    ValidationSettings settings;
    settings.suppress_host_name = (choice & 16U) != 0;
    settings.suppress_find_revocation_list = (choice & 32U) != 0;
    settings.suppress_find_issuer_revocation_list = (choice & 32U) != 0;
    TrustList list{{test::fuzz_root()}, {}, {}, {}};
    if ((choice & 64U) != 0) {
        list.trusted.push_back(chain->front());
    }
    const auto refusal = check_chain(*chain, list, context, settings);
    if (refusal && text(*refusal).empty()) {
        __builtin_trap();
    }
    run_steps(*chain, list, context);
    return 0;
}

} // namespace certificate_fuzz
