#include <busbar/core/text.hpp>
#include <busbar/crypto/certificate_validator.hpp>

#include <algorithm>
#include <array>
#include <utility>

#include "certificate_checks.hpp"
#include "certificate_folder.hpp"
#include "certificate_path.hpp"

namespace busbar::crypto {

namespace {

namespace fs = std::filesystem;

/// What a check found: on which certificate of the chain, 0 for the leaf.
struct Finding {
    StatusCode code;
    std::size_t depth{0};
};

/// What the operator reads: which check of Part 4, 6.1.3 failed and what can be done.
struct Explanation {
    StatusCode code;
    std::string_view text;
};

constexpr std::array explanations = {
    Explanation{status::Bad_CertificateInvalid,
                "structure or signature is wrong; the peer needs another certificate"},
    Explanation{status::Bad_CertificateChainIncomplete,
                "the chain does not reach a root; put the missing CA certificates into issuers"},
    Explanation{status::Bad_CertificatePolicyCheckFailed,
                "key size or signature algorithm is not what the security policy asks for"},
    Explanation{status::Bad_CertificateUntrusted,
                "neither it nor one of its issuers is trusted; to trust it, move it from rejected "
                "to trusted"},
    Explanation{status::Bad_CertificateTimeInvalid,
                "not valid now; renew it, or set this machine's clock"},
    Explanation{status::Bad_CertificateIssuerTimeInvalid,
                "issuer not valid now; renew it, or set this machine's clock"},
    Explanation{status::Bad_CertificateHostNameInvalid,
                "does not name the host that was connected to"},
    Explanation{status::Bad_CertificateUriInvalid,
                "does not name the peer's ApplicationUri, once and exactly"},
    Explanation{status::Bad_CertificateUseNotAllowed,
                "key usage must allow digitalSignature and dataEncipherment, extended key usage "
                "serverAuth or clientAuth"},
    Explanation{status::Bad_CertificateIssuerUseNotAllowed,
                "issuer is not marked as a CA that may sign certificates"},
};

std::string_view explanation_of(StatusCode code)
{
    const auto found = std::find_if(explanations.begin(), explanations.end(),
                                    [&](const Explanation& e) { return e.code == code; });
    return found == explanations.end() ? "" : found->text;
}

StatusCode check_path_policy(const CertificateChain& path, const SecurityPolicy* policy)
{
    const StatusCode leaf = detail::check_policy(path.front(), policy);
    if (!leaf.is_good()) {
        return leaf;
    }
    for (std::size_t i = 1; i < path.size(); ++i) {
        const StatusCode issuer = detail::check_issuer_policy(path[i], policy);
        if (!issuer.is_good()) {
            return issuer;
        }
    }
    return {};
}

bool is_trusted(const CertificateChain& path, const std::vector<Certificate>& trusted)
{
    return std::any_of(path.begin(), path.end(), [&](const Certificate& certificate) {
        return std::find(trusted.begin(), trusted.end(), certificate) != trusted.end();
    });
}

Finding check_time(const CertificateChain& path, DateTime now)
{
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (!detail::is_valid_at(path[i], now)) {
            return {i == 0 ? status::Bad_CertificateTimeInvalid
                           : status::Bad_CertificateIssuerTimeInvalid,
                    i};
        }
    }
    return {};
}

/// Part 4, 6.1.3, table 100, in its order; steps 10 and 11 would be revocation.
Finding check_all(const detail::CertificatePath& path, const std::vector<Certificate>& trusted,
                  const ValidationContext& context)
{
    const Certificate& leaf = path.certificates.front();
    for (const StatusCode code : {detail::check_structure(leaf), path.build,
                                  check_path_policy(path.certificates, context.policy)}) {
        if (!code.is_good()) {
            return {code};
        }
    }
    if (!is_trusted(path.certificates, trusted)) {
        return {status::Bad_CertificateUntrusted};
    }
    const Finding time = check_time(path.certificates, context.now);
    if (!time.code.is_good()) {
        return time;
    }
    for (const StatusCode code : {detail::check_host_name(leaf, context.host_name),
                                  detail::check_application_uri(leaf, context.application_uri),
                                  detail::check_usage(leaf), path.usage}) {
        if (!code.is_good()) {
            return {code};
        }
    }
    return {};
}

} // namespace

struct TrustFolder::Folders {
    explicit Folders(const fs::path& folder)
        : trusted{folder / "trusted"}, issuers{folder / "issuers"}, rejected{
                                                                        folder / "rejected",
                                                                        max_rejected,
                                                                        max_rejected_per_minute}
    {
    }

    detail::CertificateFolder trusted;
    detail::CertificateFolder issuers;
    detail::RejectedFolder rejected;
};

TrustFolder::TrustFolder(std::string folder, LogSink& log)
    : folders_{std::make_unique<Folders>(fs::path{std::move(folder)})}, log_{&log}
{
}

TrustFolder::~TrustFolder() = default;

Result<void> TrustFolder::create()
{
    for (const fs::path& path :
         {folders_->trusted.path(), folders_->issuers.path(), folders_->rejected.path()}) {
        std::error_code error;
        fs::create_directories(path, error);
        if (error) {
            return fail(status::Bad_ConfigurationError);
        }
    }
    return {};
}

Checked<void> TrustFolder::validate(const CertificateChain& chain, const ValidationContext& context)
{
    if (chain.empty() || chain.size() > max_chain_length) {
        return refuse({status::Bad_CertificateInvalid, "Certificate Structure",
                       std::to_string(chain.size()) + " certificates", "Part 4, 6.1.3, Table 100",
                       "The peer needs another certificate"});
    }
    const std::vector<Certificate> trusted = folders_->trusted.certificates();
    std::vector<Certificate> known = folders_->issuers.certificates();
    known.insert(known.end(), trusted.begin(), trusted.end());
    detail::CertificatePath path = detail::find_path(chain, known, context.now);
    if (path.certificates.empty()) {
        path.certificates = {chain.front()};
    }
    const Finding finding = check_all(path, trusted, context);
    if (finding.code.is_good()) {
        return {};
    }
    if (finding.code == status::Bad_CertificateUntrusted ||
        finding.code == status::Bad_CertificateChainIncomplete) {
        folders_->rejected.save(chain.front(), context.now);
    }
    const Certificate& culprit = path.certificates[finding.depth];
    return refuse({finding.code, "certificate validation",
                   std::string{explanation_of(finding.code)}, "Part 4, 6.1.3, Table 100",
                   {}, printable(culprit.subject()), culprit.thumbprint_text()});
}

} // namespace busbar::crypto
