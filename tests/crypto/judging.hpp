#pragma once

#include <algorithm>
#include <optional>

#include <catch2/catch.hpp>

#include <busbar/crypto/certificate_validator.hpp>

#include "revoking.hpp"
#include "status_text.hpp"

/// Certificate validation with verbs.
namespace busbar::test {

inline constexpr StatusCode good{};

/// Somebody with a trust list who is shown certificates.
class Judge {
public:
    Judge()
    {
        context.policy = crypto::find_policy_by_name("Basic256Sha256");
        context.now = now;
    }

    void trusts(const Issued& issued) { list.trusted.push_back(issued.certificate); }
    void knows_issuer(const Issued& issued) { list.issuers.push_back(issued.certificate); }
    void has(const crypto::RevocationList& revocations) { list.issuer_crls.push_back(revocations); }

    /// Good, or why the chain was refused; `refusal` has the rest.
    StatusCode verdict(const crypto::CertificateChain& chain)
    {
        suppressed.clear();
        refusal = crypto::check_chain(chain, list, context, settings, &suppressed);
        return refusal ? refusal->status : good;
    }
    StatusCode verdict(const Issued& leaf) { return verdict({leaf.certificate}); }

    /// Whether the explain line of the last refusal has all that an operator needs: the step, the
    /// certificate and the words.
    [[nodiscard]] bool explains(std::string_view step, const Issued& culprit,
                                std::initializer_list<std::string_view> words) const
    {
        return refusal && explains(*refusal, step, culprit, words);
    }
    [[nodiscard]] static bool explains(const Refusal& one, std::string_view step,
                                       const Issued& culprit,
                                       std::initializer_list<std::string_view> words)
    {
        const std::string line = text(one);
        UNSCOPED_INFO(line);
        const auto has = [&](std::string_view word) {
            return line.find(word) != std::string::npos;
        };
        return line.starts_with(std::string{step} + " failed: ") && has(name(one.status)) &&
               has("Part 4, 6.1.3, Table 100") && !one.remedy.empty() &&
               one.subject == culprit.certificate.subject() && has(one.subject) &&
               one.thumbprint == culprit.certificate.thumbprint_text() && has(one.thumbprint) &&
               !has("\n") && std::all_of(words.begin(), words.end(), has);
    }

    crypto::TrustList list;
    crypto::ValidationContext context;
    crypto::ValidationSettings settings;
    std::vector<Refusal> suppressed;
    std::optional<Refusal> refusal;
};

inline Issued leaf_of(const Issued* issuer, void (*change)(CertificateOptions&) = nullptr)
{
    CertificateOptions options;
    if (change != nullptr) {
        change(options);
    }
    return issue(options, key_number(1), issuer);
}

inline Issued self_signed(void (*change)(CertificateOptions&) = nullptr)
{
    return leaf_of(nullptr, change);
}

/// A root, an authority below it and a leaf below that; who judges trusts the root, knows the other
/// and has both revocation lists.
struct Family {
    Issued root = issue(authority("root"), key_number(2));
    Issued middle = issue(authority("middle"), key_number(3), &root);
    Issued leaf = leaf_of(&middle);

    void introduce_to(Judge& judge) const
    {
        judge.trusts(root);
        judge.knows_issuer(middle);
        judge.has(revoke(root));
        judge.has(revoke(middle));
    }
};

} // namespace busbar::test
