#include <algorithm>

#include "certificate_checks.hpp"

/// The steps "Find Revocation List" and "Revocation Check" of Part 4, 6.1.3, Table 100.
namespace busbar::crypto::detail {

namespace {

using Lists = std::vector<const RevocationList*>;

/// Returns the lists that name `issuer` as theirs, the newest first, wherever they are.
Lists lists_naming(const Certificate& issuer, const TrustList& list)
{
    Lists found;
    for (const auto* lists : {&list.trusted_crls, &list.issuer_crls}) {
        for (const RevocationList& one : *lists) {
            if (one.names_issuer(issuer)) {
                found.push_back(&one);
            }
        }
    }
    std::stable_sort(found.begin(), found.end(), [](const RevocationList* a, const auto* b) {
        return b->this_update() < a->this_update();
    });
    return found;
}

/// True if the list is signed by the issuer and not from the future.
bool is_genuine(const RevocationList& list, const Certificate& issuer, const Validation& validation)
{
    return list.this_update() <= validation.context.now &&
           validation.signatures.is_signed_by(list, issuer);
}

std::string why_unknown(const Certificate& issuer, const Validation& validation)
{
    const Lists lists = lists_naming(issuer, validation.list);
    const auto newest = std::find_if(lists.begin(), lists.end(), [&](const RevocationList* list) {
        return is_genuine(*list, issuer, validation);
    });
    const std::string of_issuer = " of its issuer, " + label_of(issuer);
    if (lists.empty()) {
        return "there is no revocation list" + of_issuer;
    }
    if (newest == lists.end()) {
        return "no revocation list in the name" + of_issuer +
               ", is signed with its key and not of the future";
    }
    if (!(*newest)->is_complete()) {
        return "the newest revocation list" + of_issuer +
               ", is a delta or partial list, or has an unknown critical extension";
    }
    // RFC 5280, 5.1.2.5: every list has the time of the next one; until then it is current.
    if (validation.context.now <= (*newest)->next_update()) {
        return {};
    }
    return "the newest revocation list" + of_issuer + ", was to be renewed by " +
           to_string((*newest)->next_update()) + ", now " + to_string(validation.context.now);
}

/// A root has no issuer, so that only its owner could revoke it: by removing it from the trust
/// list.
const Certificate* issuer_of(const Validation& validation, std::size_t index)
{
    return index + 1 < validation.path.size() ? &validation.path[index + 1] : nullptr;
}

} // namespace

/// The newest list counts. A delta or partial one is not skipped in favour of an older one, because
/// the administrator who installed it relies on it.
std::optional<Finding> find_revocation_list(const Validation& validation, std::size_t index)
{
    const Certificate* const issuer = issuer_of(validation, index);
    std::string found = issuer != nullptr ? why_unknown(*issuer, validation) : "";
    if (found.empty()) {
        return std::nullopt;
    }
    return Finding{std::move(found),
                   "Fetch the current revocation list of this CA and put it into the crl folder of "
                   "trusted or issuers"};
}

/// Checks also if the revocations are not completely known: all available lists count, down to the
/// newest complete one, even if that is out of date.
std::optional<Finding> check_revocation(const Validation& validation, std::size_t index)
{
    const Certificate* const issuer = issuer_of(validation, index);
    if (issuer == nullptr) {
        return std::nullopt;
    }
    for (const RevocationList* list : lists_naming(*issuer, validation.list)) {
        if (!is_genuine(*list, *issuer, validation)) {
            continue;
        }
        if (const auto revoked = list->revoked_at(validation.path[index])) {
            return Finding{"revoked " + to_string(*revoked) + " by " + label_of(*issuer),
                           "The peer needs a new certificate with a new key"};
        }
        if (list->is_complete()) {
            break;
        }
    }
    return std::nullopt;
}

} // namespace busbar::crypto::detail
