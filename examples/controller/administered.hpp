#pragma once

#include <busbar/administration/administration.hpp>
#include <busbar/administration/audit_log.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "config.hpp"
#include "toml_reader.hpp"

namespace busbar::example {

/// What administrators change while the controller runs, kept in the folder of certificates.
class Administered {
public:
    /// Throws a ConfigError if what is kept cannot be read. Both must outlive it.
    Administered(const ControllerConfig& config, const WallClock& clock, LogSink& lines)
        : audit_{lines}, files_{config.certificates.folder},
          is_auditing_{config.server.is_auditing}, administration_{{.wall_clock = &clock,
                                                                    .log = &audit_,
                                                                    .roles = &roles_}}
    {
        expect(roles_.load());
    }

    /// The server's log.
    [[nodiscard]] LogSink& log() { return audit_; }
    [[nodiscard]] const server::RoleMapper& roles() const { return roles_; }
    /// Once, before clients connect. Throws ConfigError.
    void attach(server::Server& server)
    {
        expect(administration_.attach(server));
        if (is_auditing_) {
            audit_.attach(server.event_queue(), server.config().application_uri);
        }
    }

private:
    administration::AuditLog audit_;
    storage::FolderStorage files_;
    bool is_auditing_;
    administration::RoleList roles_{files_, "roles.json"};
    administration::Administration administration_;
};

} // namespace busbar::example
