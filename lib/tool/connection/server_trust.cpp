#include "server_trust.hpp"

#include <algorithm>
#include <array>
#include <iostream>

#include <unistd.h>

#include <busbar/core/status_codes.hpp>

#include "tool/printing/display_text.hpp"

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

bool confirm(Context& context, const std::string& question)
{
    if (!context.err.is_terminal() || ::isatty(STDIN_FILENO) != 1) {
        return false;
    }
    context.err.write(question + " [y/N] ");
    std::string answer;
    std::getline(std::cin, answer);
    return answer == "y" || answer == "Y" || answer == "yes";
}

Checked<void> ServerTrust::validate(const crypto::CertificateChain& chain,
                                    const crypto::ValidationContext& context)
{
    auto checked = validator_.validate(chain, context);
    if (checked) {
        refused_.reset();
        warn_of_suppressed();
    } else {
        refused_ = Refused{chain.front(), checked.error()};
    }
    return checked;
}

void ServerTrust::warn_of_suppressed()
{
    for (const Refusal& passed : validator_.suppressed()) {
        const std::string step = switch_for(passed.status);
        if (warned_.insert(step + passed.found).second) {
            context_->warn("warning", step + ": " + passed.found);
        }
    }
}

bool ServerTrust::reconsider(Context& context)
{
    // Trusting a certificate does not mend anything else that is wrong with it.
    if (!refused_ || refused_->why.status != status::Bad_CertificateUntrusted) {
        return false;
    }
    const crypto::Certificate& leaf = refused_->leaf;
    const std::string description = "  subject:     " + safe(leaf.subject()) +
                                    "\n  application: " + safe(leaf.application_uri()) +
                                    "\n  thumbprint:  " + leaf.thumbprint_text() +
                                    "\n  valid:       " + to_string(leaf.valid_from()) + " to " +
                                    to_string(leaf.valid_to());
    if (!context.options.trusts) {
        context.err.is_terminal() ? context.err.line("The server at " + safe(context.options.url) +
                                                     " is not known:\n" + description)
                                  : void();
        if (!confirm(context, "Trust it from now on?")) {
            return false;
        }
    } else if (!context.options.is_json) {
        context.err.line("busbar: trusted from now on:\n" + description);
    }
    static_cast<void>(
        expect(pki_->store().add(crypto::StoreList::Trusted, leaf.der()), "the certificate"));
    static_cast<void>(pki_->store().remove(crypto::StoreList::Rejected, leaf.thumbprint_text()));
    return true;
}

Failure ServerTrust::failure() const
{
    const std::string thumbprint = refused_->leaf.thumbprint_text();
    const Refusal& why = refused_->why;
    std::string what =
        "the server's certificate (" + refused_->leaf.subject() + ", " + thumbprint + ")";
    if (why.status != status::Bad_CertificateUntrusted) {
        what += ": " + why.found;
        const std::string ignoring = switch_for(why.status);
        if (ignoring.empty() || why.remedy.empty()) {
            return {why.status, what, why.remedy};
        }
        return {why.status, what, why.remedy + "; or do without this check: " + ignoring};
    }
    return {refused_->why.status, what,
            "compare the thumbprint with the server's, then `busbar cert trust " + thumbprint +
                "`, or --trust once; the certificate lies in " + pki_->folder() + "/rejected"};
}

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
