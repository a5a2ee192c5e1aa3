#pragma once

#include <memory>
#include <string>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/crypto/certificate_store.hpp>
#include <busbar/net/system.hpp>
#include <busbar/server/server.hpp>

namespace busbar::client {
struct ClientConfig;
} // namespace busbar::client

namespace busbar::net {

class ServerLoop;

/// The names of an application, and the place of its certificates.
struct ApplicationSettings {
    /// Globally unique for this installation; the certificate contains it.
    std::string uri;
    std::string name;
    /// The folder of certificates and keys (layout of Part 12, F.1); created if it is missing.
    std::string folder;
    /// DNS names and addresses of this machine that a new certificate names.
    std::vector<std::string> host_names{"localhost"};
};

/// The environment of a program on an operating system, besides its servers and clients: random
/// numbers, the time of day, its certificate, created if missing, and its trust lists. No peer is
/// trusted before its certificate is moved from rejected/certs to trusted/certs.
///
/// Used on one thread, that of the servers and clients, which it must outlive.
class BUSBAR_API Application {
public:
    /// Opens the application; may take seconds to generate a key. `log` must outlive the object.
    /// The problem describes the folder or a file in it.
    [[nodiscard]] static Configured<std::unique_ptr<Application>> open(ApplicationSettings settings,
                                                                       LogSink& log);
    Application(const Application&) = delete;
    Application& operator=(const Application&) = delete;
    ~Application();

    /// Returns the configuration of a secure server with the application's names and certificate,
    /// which clients find at `endpoint_url`; its port is the one to listen on. The endpoints are
    /// those of ServerConfig.
    [[nodiscard]] server::ServerConfig server_config(std::string endpoint_url) const;
    /// `loop` wakes the server when its data sources have data. Without users no login succeeds.
    [[nodiscard]] server::ServerEnvironment server_environment(ServerLoop& loop,
                                                               server::UserStore* users = nullptr);
    /// Returns the configuration of a client with the application's names.
    [[nodiscard]] client::ClientConfig client_config(std::string endpoint_url) const;
    /// The environment of clients; valid as long as the Application.
    [[nodiscard]] const channel::ChannelEnvironment& client_environment() const;

    [[nodiscard]] crypto::CertificateStore& certificates();
    [[nodiscard]] crypto::Random& random();
    [[nodiscard]] const WallClock& wall_clock() const;

private:
    struct Impl;
    explicit Application(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::net
