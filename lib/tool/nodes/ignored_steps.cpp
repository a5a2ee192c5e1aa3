#include "ignored_steps.hpp"

#include <algorithm>
#include <array>

#include <busbar/core/status_codes.hpp>

namespace busbar::tool {

namespace {

struct Step {
    std::string_view name;
    StatusCode status;
    bool crypto::ValidationSettings::*setting;
};

/// The steps of Part 4, 6.1.3, Table 100 that may be suppressed, with their names there.
constexpr std::array steps{
    Step{"host-name", status::Bad_CertificateHostNameInvalid,
         &crypto::ValidationSettings::suppress_host_name},
    Step{"validity-period", status::Bad_CertificateTimeInvalid,
         &crypto::ValidationSettings::suppress_validity_period},
    Step{"issuer-validity-period", status::Bad_CertificateIssuerTimeInvalid,
         &crypto::ValidationSettings::suppress_issuer_validity_period},
    Step{"certificate-usage", status::Bad_CertificateUseNotAllowed,
         &crypto::ValidationSettings::suppress_certificate_usage},
    Step{"security-policy-check", status::Bad_CertificatePolicyCheckFailed,
         &crypto::ValidationSettings::suppress_security_policy_check},
    Step{"find-revocation-list", status::Bad_CertificateRevocationUnknown,
         &crypto::ValidationSettings::suppress_find_revocation_list},
    Step{"find-issuer-revocation-list", status::Bad_CertificateIssuerRevocationUnknown,
         &crypto::ValidationSettings::suppress_find_issuer_revocation_list},
};

} // namespace

std::vector<std::string> ignorable_steps()
{
    std::vector<std::string> names;
    for (const Step& step : steps) {
        names.emplace_back(step.name);
    }
    return names;
}

crypto::ValidationSettings settings_of(const std::vector<std::string>& names)
{
    crypto::ValidationSettings settings;
    for (const Step& step : steps) {
        settings.*step.setting = std::find(names.begin(), names.end(), step.name) != names.end();
    }
    return settings;
}

std::string switch_for(StatusCode status)
{
    const auto* const found = std::find_if(steps.begin(), steps.end(),
                                           [&](const Step& step) { return step.status == status; });
    return found == steps.end() ? "" : "--ignore " + std::string{found->name};
}

} // namespace busbar::tool
