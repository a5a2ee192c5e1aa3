#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/types.hpp>
#include <busbar/model/node.hpp>
#include <busbar/net/application.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/server/server.hpp>

namespace busbar::net {

/// A server as a program: its loop, log, certificate, users and variables in memory, owned in the
/// right order. What is not here is reached by server(), before run() and from its callbacks.
///
/// What fails first is kept: later calls do nothing, and status() and run() tell it, so that a
/// program has one place where it looks. One thread.
class BUSBAR_API ServerApp {
public:
    /// Clients find the server at `endpoint_url`, of which the port is listened on, on every
    /// address of the machine. Makes the certificate if it is missing, which may take seconds.
    explicit ServerApp(ApplicationSettings settings,
                       std::string endpoint_url = "opc.tcp://localhost:4840");
    ServerApp(const ServerApp&) = delete;
    ServerApp& operator=(const ServerApp&) = delete;
    ~ServerApp();

    /// Somebody who may log in; `password` may be null, as what an environment does not have, and
    /// is refused then. Nobody may before there is one.
    void add_user(std::string_view name, const char* password);
    /// The index of the namespace; 0 if something has failed.
    std::uint16_t add_namespace(std::string_view uri);
    /// A Variable below the Objects folder, with `value` in memory; its NodeId is its name's text.
    /// What set() wants of it; nothing useful if something has failed.
    std::uint64_t add_variable(const QualifiedName& name, const Variant& value,
                               model::Access access = model::Access::Read);
    /// Gives such a Variable another value.
    void set(std::uint64_t variable, Variant value);

    [[nodiscard]] const Checked<void>& status() const;
    /// Null if it could not be made.
    [[nodiscard]] server::Server* server();
    [[nodiscard]] server::PasswordUsers& users();

    /// Serves until SIGINT or SIGTERM. What main() may return: 0, or 1 if something has failed,
    /// which stands on the standard error output then.
    [[nodiscard]] int run();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::net
