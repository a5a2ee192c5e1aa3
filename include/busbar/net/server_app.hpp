#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/types.hpp>
#include <busbar/model/new_node.hpp>
#include <busbar/net/application.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/server/server.hpp>

namespace busbar::net {

/// A server as a program: its loop, log, certificate, users, data sources and variables in memory,
/// owned in the right order. Everything else is reached through server(), before run() and from its
/// callbacks.
///
/// The first failure is kept: later calls do nothing, and status() and run() report it, so that a
/// program has one place to look. One thread.
class BUSBAR_API ServerApp {
public:
    /// Clients find the server at `endpoint_url`. It listens on that port, on every address of the
    /// machine. Creates the certificate if it is missing, which may take seconds.
    explicit ServerApp(ApplicationSettings settings,
                       std::string endpoint_url = "opc.tcp://localhost:4840");
    ServerApp(const ServerApp&) = delete;
    ServerApp& operator=(const ServerApp&) = delete;
    ~ServerApp();

    /// Adds a user. `password` may be null, as from getenv(), and is then refused. No login
    /// succeeds before there is a user.
    void add_user(std::string_view name, const char* password);
    /// Returns the index of the namespace; 0 if something has failed.
    std::uint16_t add_namespace(std::string_view uri);
    /// Creates a data source, which lives as long as the server needs it.
    template <typename Source, typename... Arguments>
    Source& make_source(Arguments&&... arguments)
    {
        auto made = std::make_shared<Source>(std::forward<Arguments>(arguments)...);
        Source& source = *made;
        add_source(std::move(made));
        return source;
    }
    /// Adds a Variable below the Objects folder, as AddressSpace::add_variable does: one that a
    /// source serves (DataSource::variable), or a value, which is then kept in memory. Returns the
    /// handle, which is meaningless if something has failed: see status().
    std::uint64_t add_variable(const QualifiedName& name, const model::BoundValue& value,
                               model::Access access = model::Access::Read);
    /// Changes the value of a Variable that was added with a value of its own.
    void set(std::uint64_t variable, Variant value);

    [[nodiscard]] const Configured<void>& status() const;
    /// Null if the server could not be created.
    [[nodiscard]] server::Server* server();
    [[nodiscard]] server::PasswordUsers& users();

    /// Serves until SIGINT or SIGTERM, and logs "ready at opc.tcp://..." before. Returns what
    /// main() may return: 0, or 1 after a failure, which it prints on the standard error output.
    [[nodiscard]] int run();

private:
    void add_source(std::shared_ptr<server::DataSource> source);

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::net
