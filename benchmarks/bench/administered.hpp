#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/worker.hpp>

namespace busbar::bench {

/// The roles of administration. A server that is administered has a user of the same name with each
/// of them, and the password good_password.
inline constexpr std::array<std::string_view, 5> administration_roles{
    "SecurityAdmin", "ConfigureAdmin", "Engineer", "Supervisor", "Operator"};

/// What an administered server has beside itself: users, roles, certificates, settings, files and
/// temporary files in a folder on the disk, and the nodes to change them. Its settings change
/// nothing: what a program does with them comes on top.
class Administered {
public:
    /// What all of it needs, which must outlive it.
    struct Needs {
        std::string folder;
        LogSink& log;
        const WallClock& clock;
        crypto::Random& random;
        server::PasswordUsers& users;
        server::Worker& worker;
    };

    explicit Administered(const Needs& needs);
    Administered(const Administered&) = delete;
    Administered& operator=(const Administered&) = delete;
    ~Administered();

    /// Makes the folder's contents; before the server, whose identity and URI these are.
    [[nodiscard]] bool prepare(const channel::ApplicationIdentity& identity,
                               const std::string& application_uri);
    [[nodiscard]] const server::RoleMapper& roles() const;
    /// Adds the nodes; before clients connect.
    [[nodiscard]] bool attach(server::Server& server);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

} // namespace busbar::bench
