#include <busbar/channel/server_certificate.hpp>

#include <busbar/channel/endpoint_url.hpp>

namespace busbar::channel {

Checked<void> validate_server(const ChannelEnvironment& environment,
                              const crypto::CertificateChain& chain,
                              const crypto::SecurityPolicy& policy, std::string_view server_uri,
                              std::string_view endpoint_url)
{
    const auto url = EndpointUrl::parse(endpoint_url);
    return environment.validator->validate(chain,
                                           {&policy, environment.wall_clock->now(), server_uri,
                                            url ? std::string_view{url->host} : std::string_view{},
                                            crypto::CertificatePurpose::ServerApplication});
}

} // namespace busbar::channel
