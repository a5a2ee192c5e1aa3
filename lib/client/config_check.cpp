#include <busbar/client/config_check.hpp>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/text.hpp>

namespace busbar::client {

namespace {

Configured<void> check_environment(const ClientConfig& config,
                                   const channel::ChannelEnvironment& environment)
{
    const auto missing = [](const char* field, const char* need) {
        return misconfigured(field, std::string{"is null, which "} + need);
    };
    constexpr const char* any = "a client needs";
    constexpr const char* secure = "takes security.allows_none, expected one";
    if (environment.random == nullptr) {
        return missing("environment.random", any);
    }
    if (environment.wall_clock == nullptr) {
        return missing("environment.wall_clock", any);
    }
    if (environment.log == nullptr) {
        return missing("environment.log", any);
    }
    if (config.security.allows_none) {
        return {};
    }
    if (environment.validator == nullptr) {
        return missing("environment.validator", secure);
    }
    if (environment.identity == nullptr) {
        return missing("environment.identity", secure);
    }
    return {};
}

Configured<void> check_security(const SecurityWishes& wishes)
{
    for (const std::string& wish : wishes.policies) {
        if (crypto::find_policy(wish) == nullptr && crypto::find_policy_by_name(wish) == nullptr) {
            return misconfigured("security.policies", "this build knows no " + printable(wish) +
                                                          ". Correct its name; deprecated policies "
                                                          "are an option of the build");
        }
    }
    return {};
}

Configured<void> check_user(const UserIdentity& identity)
{
    const auto* const user = std::get_if<CertificateUser>(&identity);
    if (user != nullptr && user->key == nullptr) {
        return misconfigured("identity", "there is a certificate but no key");
    }
    return {};
}

} // namespace

Configured<void> check_config(const ClientConfig& config,
                              const channel::ChannelEnvironment& environment)
{
    if (auto checked = check_environment(config, environment); !checked) {
        return checked;
    }
    // For a client that waits for the server the URL is only a name.
    if (!config.is_reverse && !channel::EndpointUrl::parse(config.endpoint_url)) {
        return misconfigured("endpoint_url",
                             "\"" + printable(config.endpoint_url) +
                                 "\" is not a URL like opc.tcp://host:port",
                             status::Bad_TcpEndpointUrlInvalid);
    }
    if (auto checked = check_security(config.security); !checked) {
        return checked;
    }
    return check_user(config.identity);
}

} // namespace busbar::client
