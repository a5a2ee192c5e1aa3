#pragma once

#include <string>
#include <vector>

#include <busbar/crypto/revocation_list.hpp>

#include "issuing.hpp"

/// Revocation lists of every kind, right and wrong, made by the tests themselves.
namespace busbar::test {

struct RevocationOptions {
    std::vector<crypto::Certificate> revoked{};
    DateTime this_update{in_days(-1)};
    DateTime next_update{in_days(30)}; // null: the list does not say
    DateTime revoked_at{in_days(-2)};
    std::string distribution_point{}; // issuingDistributionPoint, as openssl's configuration has it
    std::string extra{};              // one more extension, as DER of OID 1.2.3.4, critical
    std::string entry_extra{};        // the same in each entry
    bool is_delta{false};             // deltaCRLIndicator, critical
    const char* digest{"SHA256"};
};

/// Signed by `issuer` in its name.
[[nodiscard]] crypto::RevocationList revoke(const Issued& issuer,
                                            const RevocationOptions& options = {});
[[nodiscard]] std::vector<std::byte> pem_of(const crypto::RevocationList& list);

} // namespace busbar::test
