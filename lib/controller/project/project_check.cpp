#include <algorithm>
#include <array>
#include <numeric>

#include <busbar/channel/channel_types.hpp>
#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/text.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/security_policy.hpp>
#include <busbar/server/password_rules.hpp>

#include "project_rules.hpp"

namespace busbar::controller {

namespace detail {

namespace {

constexpr std::string_view project_preset = "rd81opc96";
/// Limits of SH-082679, 2.1.
constexpr std::size_t max_preset_files = 10;
constexpr std::size_t max_preset_size = 20U << 20U;
/// The range of [discovery] in busbar-controller's configuration: 10 minutes at most (Part 12,
/// 4.3.3).
constexpr std::uint32_t min_registration = 10;
constexpr std::uint32_t max_registration = 600;

/// The maximum sizes of RFC 5280 (A.1) and of SH-082679 (Appendix 6).
struct CertificateField {
    std::string_view name;
    std::string ProjectCertificate::*value;
    std::size_t longest;
    Characters characters;
};
constexpr std::array certificate_fields{
    CertificateField{"server_name", &ProjectCertificate::server_name, 64, Characters::Word},
    CertificateField{"organization", &ProjectCertificate::organization, 64, Characters::Word},
    CertificateField{"unit", &ProjectCertificate::unit, 64, Characters::Word},
    CertificateField{"locality", &ProjectCertificate::locality, 128, Characters::Word},
    CertificateField{"state", &ProjectCertificate::state, 128, Characters::Word},
    CertificateField{"country", &ProjectCertificate::country, 2, Characters::UpperWord},
};

bool is_of(char c, Characters characters)
{
    const bool is_lower = c >= 'a' && c <= 'z';
    if (characters == Characters::Any) {
        return true;
    }
    if (server::letters_and_digits.find(c) != std::string_view::npos) {
        return !is_lower || characters != Characters::UpperWord;
    }
    return characters == Characters::Url ? c == ':' || c == '/' || c == '.' : c == '_';
}

} // namespace

ValueProblem wrong_value(std::string where, std::string_view found, std::string_view expected)
{
    return misconfigured(std::move(where), "found \"" + printable(found, 64) + "\", expected " +
                                               std::string{expected})
        .error();
}

ValueProblem check_characters(const std::string& where, std::string_view value,
                              Characters characters)
{
    static constexpr std::array expected{
        std::string_view{}, std::string_view{"letters, digits and \"_\""},
        std::string_view{"upper-case letters, digits and \"_\""},
        std::string_view{"letters, digits, \":\", \"/\" and \".\""}};
    const bool fits =
        std::all_of(value.begin(), value.end(), [&](char c) { return is_of(c, characters); });
    return fits ? ValueProblem{}
                : wrong_value(where, value, expected.at(static_cast<std::size_t>(characters)));
}

ValueProblem check_security(const ProjectSecurity& security)
{
    const auto& policies = security.policies;
    for (auto each = policies.begin(); each != policies.end(); ++each) {
        const auto* const policy = crypto::find_policy_by_name(*each);
        if (policy == nullptr || policy->is_none() ||
            std::find(policies.begin(), each, *each) != each) {
            return wrong_value("[security] policies", *each,
                               "policies that this program has, each once");
        }
    }
    const bool is_none = security.mode == MessageSecurityMode::None;
    if (is_none != policies.empty()) {
        return wrong_value("[security] mode", channel::name(security.mode),
                           is_none ? "Sign or SignAndEncrypt where there are policies"
                                   : "None where there are no policies");
    }
    if (!security.allows_anonymous && !security.allows_certificates && !security.allows_passwords) {
        return wrong_value("[security] allow_passwords", "no",
                           "a way for clients to log in: certificates, passwords or anonymous");
    }
    return std::nullopt;
}

ValueProblem check_certificate(const ProjectCertificate& certificate, bool has_preset)
{
    for (const CertificateField& field : certificate_fields) {
        const std::string& value = certificate.*field.value;
        const std::string where = "[certificate] " + std::string{field.name};
        const bool is_country = field.value == &ProjectCertificate::country;
        if (value.size() > field.longest || (is_country && value.size() == 1)) {
            return wrong_value(where, value,
                               is_country ? "two letters"
                                          : "at most " + std::to_string(field.longest) + " bytes");
        }
        if (auto wrong =
                check_characters(where, value, has_preset ? field.characters : Characters::Any)) {
            return wrong;
        }
    }
    return std::nullopt;
}

ValueProblem check_discovery(const ProjectDiscovery& discovery, bool has_preset)
{
    if (discovery.interval < min_registration || discovery.interval > max_registration) {
        return wrong_value("[discovery] interval_s", std::to_string(discovery.interval),
                           "10 to 600");
    }
    if (!discovery.url.empty() && !channel::EndpointUrl::parse(discovery.url)) {
        return wrong_value("[discovery] url", discovery.url, "opc.tcp://host:port");
    }
    return check_characters("[discovery] url", discovery.url,
                            has_preset ? Characters::Url : Characters::Any);
}

ValueProblem check_users(const Project& project, bool has_preset)
{
    const server::PasswordRules rules =
        has_preset ? server::rd81opc96_password_rules() : server::PasswordRules{};
    const auto& users = project.users;
    for (auto user = users.begin(); user != users.end(); ++user) {
        const std::string where = "[user " + std::to_string(user - users.begin() + 1) + "] ";
        if (const auto name = server::check_user_name(rules, user->name); !name) {
            Problem problem = problem_of(name.error());
            problem.where = where + "name";
            return problem;
        }
        const bool is_again = std::any_of(
            users.begin(), user, [&](const ProjectUser& each) { return each.name == user->name; });
        if (is_again) {
            return wrong_value(where + "name", user->name, "each name once");
        }
        if (!crypto::is_password_hash(user->password_hash)) {
            // Do not show the value: it may be the password itself.
            return Problem{.where = where + "password_hash",
                           .text = "found no hash, expected one of busbar project user"};
        }
    }
    return std::nullopt;
}

ValueProblem check_model_files(const Project& project, bool has_preset)
{
    const std::size_t size = std::accumulate(
        project.models.begin(), project.models.end(), std::size_t{0},
        [](std::size_t sum, const ProjectModel& model) { return sum + model.text.size(); });
    if (has_preset && project.models.size() > max_preset_files) {
        return wrong_value("[model]", std::to_string(project.models.size()) + " files",
                           "at most 10");
    }
    if (has_preset && size > max_preset_size) {
        return wrong_value("[model]", std::to_string(size) + " bytes", "at most 20 MB together");
    }
    return std::nullopt;
}

} // namespace detail

Configured<void> check(const Project& project)
{
    const bool has_preset = project.preset == detail::project_preset;
    detail::ValueProblem wrong;
    if (!has_preset && !project.preset.empty()) {
        wrong = detail::wrong_value("preset", project.preset, "rd81opc96 or nothing");
    }
    const auto also = [&](auto check_part) {
        if (!wrong) {
            wrong = check_part();
        }
    };
    also([&] { return detail::check_network(project, has_preset); });
    also([&] { return detail::check_security(project.security); });
    also([&] { return detail::check_certificate(project.certificate, has_preset); });
    also([&] { return detail::check_discovery(project.discovery, has_preset); });
    also([&] { return detail::check_users(project, has_preset); });
    also([&] { return detail::check_model_files(project, has_preset); });
    return wrong ? Configured<void>{Unexpected{*std::move(wrong)}} : Configured<void>{};
}

std::vector<MessageSecurity> allowed_security(const ProjectSecurity& security)
{
    using Mode = MessageSecurityMode;
    std::vector<MessageSecurity> allowed;
    if (security.mode == Mode::None) {
        allowed.push_back({Mode::None, "None"});
    }
    for (const crypto::SecurityPolicy& policy : crypto::security_policies()) {
        const auto& named = security.policies;
        // Without a choice all policies are used, except deprecated ones, which must be named.
        const bool is_chosen =
            named.empty() ? !policy.is_deprecated
                          : std::find(named.begin(), named.end(), policy.name) != named.end();
        if (policy.is_none() || !is_chosen) {
            continue;
        }
        for (const Mode mode : {Mode::Sign, Mode::SignAndEncrypt}) {
            if (mode >= security.mode) { // all modes that are at least as strong
                allowed.push_back({mode, std::string{policy.name}});
            }
        }
    }
    return allowed;
}

} // namespace busbar::controller
