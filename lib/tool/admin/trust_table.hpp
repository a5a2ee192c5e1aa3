#pragma once

#include <string>
#include <vector>

#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/revocation_list.hpp>

#include "tool/connection/context.hpp"

/// Certificates and revocation lists of a server as `busbar admin` shows them.
namespace busbar::tool::admin {

struct CertificateRow {
    std::string list; // "own", "trusted", "issuers" or "rejected"
    crypto::Certificate certificate;
};
/// A revocation list; `list` is "trusted" or "issuers", depending on its issuer.
struct RevocationRow {
    std::string list;
    crypto::RevocationList revocations;
};
struct TrustRows {
    std::vector<CertificateRow> certificates;
    std::vector<RevocationRow> revocations;
};

/// The columns for sorting the rows of a list; the first is the default.
inline constexpr const char* trust_columns[] = {"name", "organization", "domain", "validity"};
struct TrustOrder {
    std::string column{trust_columns[0]};
    bool is_descending{false};
};

/// Prints common name, organization, domain, end of validity and thumbprint of each certificate,
/// and a table of revocation lists below; each list in this order.
void print_trust(Context& context, TrustRows rows, const TrustOrder& order = {});
/// Prints all details.
void print_details(Context& context, const CertificateRow& row);
/// Prints the same below a table with one row, or as a list with one element.
void print_own(Context& context, const CertificateRow& row);
void print_details(Context& context, const RevocationRow& row);

/// Finds the row whose thumbprint begins like this, in the first list that has one; throws Failure
/// if there is none or several.
[[nodiscard]] const CertificateRow& find(const std::vector<CertificateRow>& rows,
                                         const std::string& thumbprint);
/// The same for a revocation list; null if there is none.
[[nodiscard]] const RevocationRow* find(const std::vector<RevocationRow>& rows,
                                        const std::string& thumbprint);

} // namespace busbar::tool::admin
