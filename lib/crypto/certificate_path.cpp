#include "certificate_checks.hpp"

#include <algorithm>
#include <deque>

#include <openssl/err.h>

#include <busbar/core/text.hpp>

#include "openssl.hpp"

namespace busbar::crypto::detail {

namespace {

using Candidates = std::vector<const Certificate*>;

/// Returns whether `issuer` may have signed `certificate`, by name and key identifier. A later step
/// checks whether it may sign certificates.
bool claims_to_issue(const Certificate& issuer, const Certificate& certificate)
{
    const int result = X509_check_issued(issuer.native(), certificate.native());
    ERR_clear_error();
    return result == X509_V_OK || result == X509_V_ERR_KEYUSAGE_NO_CERTSIGN;
}

bool contains(const Candidates& certificates, const Certificate& one)
{
    return std::any_of(certificates.begin(), certificates.end(),
                       [&](const Certificate* other) { return *other == one; });
}

class PathSearch {
public:
    PathSearch(const CertificateChain& sent, const TrustList& list, DateTime now,
               SignatureChecks& signatures)
        : sent_{sent}, list_{list}, now_{now}, signatures_{signatures}
    {
    }

    [[nodiscard]] Checked<CertificateChain> run();

private:
    /// A certificate and its position in the path.
    struct Reached {
        const Certificate* certificate;
        std::size_t length;
    };

    void add_issuers(const Certificate& of, const std::vector<Certificate>& from,
                     Candidates& found) const;
    [[nodiscard]] Candidates issuers_of(const Certificate& certificate) const;
    [[nodiscard]] bool is_signed_by(const Certificate& certificate, const Certificate& issuer);
    [[nodiscard]] std::optional<Refusal> follow_names() const;
    [[nodiscard]] bool extend();
    [[nodiscard]] bool finish();
    [[nodiscard]] Refusal refuse_incomplete(const Certificate* dead_end, bool is_too_long) const;
    [[nodiscard]] Refusal refuse_signature() const;

    const CertificateChain& sent_;
    const TrustList& list_;
    DateTime now_;
    SignatureChecks& signatures_;
    Candidates path_;                            // the path that extend() is working on
    Candidates best_;                            // the first complete path, or a trusted one
    const Certificate* badly_signed_{nullptr};   // the first one found
    const Certificate* claimed_issuer_{nullptr}; // of badly_signed_
};

void PathSearch::add_issuers(const Certificate& of, const std::vector<Certificate>& from,
                             Candidates& found) const
{
    const auto first = static_cast<std::ptrdiff_t>(found.size());
    for (const Certificate& one : from) {
        if (claims_to_issue(one, of) && !contains(found, one)) {
            found.push_back(&one);
        }
    }
    std::stable_partition(found.begin() + first, found.end(),
                          [&](const Certificate* one) { return is_valid_at(*one, now_); });
}

Candidates PathSearch::issuers_of(const Certificate& certificate) const
{
    Candidates found;
    add_issuers(certificate, list_.trusted, found);
    add_issuers(certificate, list_.issuers, found);
    add_issuers(certificate, sent_, found);
    return found;
}

bool PathSearch::is_signed_by(const Certificate& certificate, const Certificate& issuer)
{
    const bool is_good = signatures_.is_signed_by(certificate, issuer);
    if (!is_good && badly_signed_ == nullptr) {
        badly_signed_ = &certificate;
        claimed_issuer_ = &issuer;
    }
    return is_good;
}

/// `dead_end` has no issuer; if null, every certificate has one.
Refusal PathSearch::refuse_incomplete(const Certificate* dead_end, bool is_too_long) const
{
    std::string found;
    std::string remedy{"The peer needs another certificate"};
    if (dead_end != nullptr) {
        found = "its issuer, " + printable(text_of(X509_get_issuer_name(dead_end->native()))) +
                ", is neither in the trust list nor among what the peer sent";
        remedy = "Put the certificates of this CA and of all above it into issuers";
    } else if (is_too_long) {
        found = "there are more than " + std::to_string(max_chain_length - 1) + " CAs above it";
    } else {
        found = "the CAs above it sign each other and lead to no root";
    }
    return refusal_of(status::Bad_CertificateChainIncomplete, "Build Certificate Chain",
                      {std::move(found), std::move(remedy)},
                      dead_end != nullptr ? *dead_end : sent_.front());
}

/// Checks that names lead to a root, in a limited number of steps; no signature is verified yet, so
/// that an incomplete chain costs nothing. Visits each certificate once, however they refer to each
/// other.
std::optional<Refusal> PathSearch::follow_names() const
{
    Candidates seen{&sent_.front()};
    std::deque<Reached> open{{&sent_.front(), 1}};
    const Certificate* dead_end = nullptr;
    bool is_too_long = false;
    for (; !open.empty(); open.pop_front()) {
        const Reached reached = open.front();
        if (is_root(*reached.certificate)) {
            return std::nullopt;
        }
        const Candidates issuers = issuers_of(*reached.certificate);
        if (issuers.empty() && dead_end == nullptr) {
            dead_end = reached.certificate;
        }
        for (const Certificate* issuer : issuers) {
            if (contains(seen, *issuer)) {
                continue;
            }
            if (reached.length == max_chain_length) {
                is_too_long = true;
                continue;
            }
            seen.push_back(issuer);
            open.push_back({issuer, reached.length + 1});
        }
    }
    return refuse_incomplete(dead_end, is_too_long);
}

bool PathSearch::finish()
{
    if (!is_signed_by(*path_.back(), *path_.back())) {
        return false;
    }
    const bool has_trusted = std::any_of(path_.begin(), path_.end(), [&](const Certificate* one) {
        return is_trusted(*one, list_);
    });
    if (has_trusted || best_.empty()) {
        best_ = path_;
    }
    return has_trusted;
}

/// Adds issuers to path_ until it is complete and trusted; else removes those that it added. No
/// deeper than max_chain_length, and each step has cost a signature.
bool PathSearch::extend()
{
    const Certificate& last = *path_.back();
    if (is_root(last)) {
        return finish();
    }
    if (path_.size() == max_chain_length) {
        return false;
    }
    for (const Certificate* issuer : issuers_of(last)) {
        if (contains(path_, *issuer) || !is_signed_by(last, *issuer)) {
            continue;
        }
        path_.push_back(issuer);
        if (extend()) {
            return true;
        }
        path_.pop_back();
    }
    return false;
}

Refusal PathSearch::refuse_signature() const
{
    std::string found;
    if (signatures_.is_used_up()) {
        found = "more than " + std::to_string(max_signature_checks) +
                " signatures would have to be verified";
    } else if (badly_signed_ == claimed_issuer_) {
        found = "it is not signed with its own key, though it names itself as its issuer";
    } else {
        found = "it is not signed with the key of its issuer, " + label_of(*claimed_issuer_);
    }
    return refusal_of(status::Bad_CertificateInvalid, "Signature",
                      {std::move(found), "The peer needs another certificate"}, *badly_signed_);
}

Checked<CertificateChain> PathSearch::run()
{
    if (auto incomplete = follow_names()) {
        return refuse(*std::move(incomplete));
    }
    path_ = {&sent_.front()};
    static_cast<void>(extend()); // also false for a complete path that is not trusted
    if (best_.empty()) {
        return refuse(refuse_signature());
    }
    CertificateChain result;
    for (const Certificate* certificate : best_) {
        result.push_back(*certificate);
    }
    return result;
}

} // namespace

Checked<CertificateChain> find_path(const CertificateChain& sent, const TrustList& list,
                                    DateTime now, SignatureChecks& signatures)
{
    return PathSearch{sent, list, now, signatures}.run();
}

} // namespace busbar::crypto::detail
