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

struct ApplicationSettings {
    /// Globally unique, for this installation; the certificate names it.
    std::string uri;
    std::string name;
    /// For certificates and keys, in the layout of Part 12, F.1; made if it is missing.
    std::string folder;
    /// DNS names and addresses of this machine that a new certificate names.
    std::vector<std::string> host_names{"localhost"};
};

/// What a program on an operating system needs around its servers and clients: random numbers, the
/// time of day, its certificate, made when missing, and its trust lists. Nobody is trusted before
/// somebody moves a certificate from rejected/certs to trusted/certs.
///
/// Used on one thread, that of the servers and clients, which it must outlive.
class BUSBAR_API Application {
public:
    /// May take seconds, for a new key. `log` must outlive the object.
    /// The problem is one of the folder or of what is in it.
    [[nodiscard]] static Configured<std::unique_ptr<Application>> open(ApplicationSettings settings,
                                                                       LogSink& log);
    Application(const Application&) = delete;
    Application& operator=(const Application&) = delete;
    ~Application();

    /// A secure server with the application's names and certificate, which clients find at
    /// `endpoint_url`; its port is the one to listen on. The endpoints are those of ServerConfig.
    [[nodiscard]] server::ServerConfig server_config(std::string endpoint_url) const;
    /// `loop` wakes the server when its data sources have something. Without users nobody logs in.
    [[nodiscard]] server::ServerEnvironment server_environment(ServerLoop& loop,
                                                               server::UserStore* users = nullptr);
    /// A client with the application's names.
    [[nodiscard]] client::ClientConfig client_config(std::string endpoint_url) const;
    /// What clients need from outside; valid as long as the Application.
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
