#include <busbar/crypto/certificate_validator.hpp>

#include <array>
#include <numeric>

#include "certificate_checks.hpp"

namespace busbar::crypto {

namespace {

using detail::Check;
using detail::Finding;
using detail::Validation;
using Setting = bool ValidationSettings::*;

/// A step of the table: one check for the leaf, one for each issuer, with the status and the
/// setting that suppresses it. Null if there is none.
struct Step {
    struct Part {
        Check check;
        StatusCode status;
        Setting suppressed_by;
    };

    std::string_view name;
    Part leaf;
    Part issuer;
};

constexpr Step::Part nothing{nullptr, {}, nullptr};
constexpr std::string_view structure_step = "Certificate Structure";

/// Part 4, 6.1.3, Table 100, in its order. "Build Certificate Chain" and "Signature" come second
/// and third; find_path performs them, since there is no path before.
constexpr std::array steps = {
    Step{structure_step,
         {detail::check_structure, status::Bad_CertificateInvalid, nullptr},
         {detail::check_structure, status::Bad_CertificateInvalid, nullptr}},
    Step{"Security Policy Check",
         {detail::check_policy, status::Bad_CertificatePolicyCheckFailed,
          &ValidationSettings::suppress_security_policy_check},
         {detail::check_policy, status::Bad_CertificatePolicyCheckFailed,
          &ValidationSettings::suppress_security_policy_check}},
    Step{"Trust List Check",
         {detail::check_trust, status::Bad_CertificateUntrusted, nullptr},
         nothing},
    Step{"Validity Period",
         {detail::check_validity, status::Bad_CertificateTimeInvalid,
          &ValidationSettings::suppress_validity_period},
         {detail::check_validity, status::Bad_CertificateIssuerTimeInvalid,
          &ValidationSettings::suppress_issuer_validity_period}},
    Step{"Host Name",
         {detail::check_host_name, status::Bad_CertificateHostNameInvalid,
          &ValidationSettings::suppress_host_name},
         nothing},
    Step{"URI", {detail::check_uri, status::Bad_CertificateUriInvalid, nullptr}, nothing},
    Step{"Certificate Usage",
         {detail::check_usage, status::Bad_CertificateUseNotAllowed,
          &ValidationSettings::suppress_certificate_usage},
         {detail::check_issuer_usage, status::Bad_CertificateIssuerUseNotAllowed, nullptr}},
    Step{"Find Revocation List",
         {detail::find_revocation_list, status::Bad_CertificateRevocationUnknown,
          &ValidationSettings::suppress_find_revocation_list},
         {detail::find_revocation_list, status::Bad_CertificateIssuerRevocationUnknown,
          &ValidationSettings::suppress_find_issuer_revocation_list}},
    Step{"Revocation Check",
         {detail::check_revocation, status::Bad_CertificateRevoked, nullptr},
         {detail::check_revocation, status::Bad_CertificateIssuerRevoked, nullptr}},
};

/// Refuses a chain that no peer needs to send before it is read.
std::optional<Refusal> check_size(const CertificateChain& chain)
{
    const std::size_t bytes = std::accumulate(chain.begin(), chain.end(), std::size_t{0},
                                              [](std::size_t sum, const Certificate& certificate) {
                                                  return sum + certificate.der().size();
                                              });
    if (!chain.empty() && chain.size() <= max_chain_length && bytes <= max_chain_size) {
        return std::nullopt;
    }
    Finding finding{"the peer sent " + std::to_string(chain.size()) + " certificates of together " +
                        std::to_string(bytes) + " bytes; 1 to " + std::to_string(max_chain_length) +
                        " and " + std::to_string(max_chain_size) + " bytes are allowed",
                    "The peer needs another certificate"};
    if (chain.empty()) {
        return Refusal{status::Bad_CertificateInvalid, structure_step, std::move(finding.found),
                       "Part 4, 6.1.3, Table 100", std::move(finding.remedy)};
    }
    return detail::refusal_of(status::Bad_CertificateInvalid, structure_step, std::move(finding),
                              chain.front());
}

std::optional<Refusal> run_step(const Step& step, const Validation& validation,
                                const ValidationSettings& settings,
                                std::vector<Refusal>* suppressed)
{
    for (std::size_t i = 0; i < validation.path.size(); ++i) {
        const Step::Part& part = i == 0 ? step.leaf : step.issuer;
        auto finding = part.check != nullptr ? part.check(validation, i) : std::nullopt;
        if (!finding) {
            continue;
        }
        const bool is_suppressed =
            part.suppressed_by != nullptr && settings.*part.suppressed_by && !finding->is_mandatory;
        auto refusal =
            detail::refusal_of(part.status, step.name, *std::move(finding), validation.path[i]);
        if (!is_suppressed) {
            return refusal;
        }
        if (suppressed != nullptr) {
            suppressed->push_back(std::move(refusal));
        }
    }
    return std::nullopt;
}

std::optional<Refusal> run_steps(const Validation& validation, const ValidationSettings& settings,
                                 std::vector<Refusal>* suppressed)
{
    for (const Step& step : steps) {
        if (auto refusal = run_step(step, validation, settings, suppressed)) {
            return refusal;
        }
    }
    return std::nullopt;
}

} // namespace

std::optional<Refusal> check_chain(const CertificateChain& chain, const TrustList& list,
                                   const ValidationContext& context,
                                   const ValidationSettings& settings,
                                   std::vector<Refusal>* suppressed)
{
    if (auto refusal = check_size(chain)) {
        return refusal;
    }
    detail::SignatureChecks signatures;
    const CertificateChain leaf{chain.front()};
    if (auto refusal =
            run_step(steps.front(), {leaf, list, context, signatures}, settings, nullptr)) {
        return refusal;
    }
    const auto path = detail::find_path(chain, list, context.now, signatures);
    if (!path) {
        return path.error();
    }
    return run_steps({*path, list, context, signatures}, settings, suppressed);
}

Checked<void> check_certificate(const Certificate& leaf, const ValidationContext& context)
{
    const CertificateChain path{leaf};
    const TrustList list{path, {}, {}, {}};
    detail::SignatureChecks signatures;
    auto refusal = run_steps({path, list, context, signatures}, {}, nullptr);
    return refusal ? Checked<void>{refuse(*std::move(refusal))} : Checked<void>{};
}

} // namespace busbar::crypto
