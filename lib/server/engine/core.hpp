#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include <busbar/crypto/certificate_notices.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/enumerations.hpp>

#include "guards.hpp"
#include "model_changes.hpp"
#include "server/data/data_sources.hpp"
#include "server/diagnostics/diagnostics.hpp"
#include "server/diagnostics/session_nodes.hpp"
#include "server/event/events.hpp"
#include "server/node_management/client_nodes.hpp"
#include "server/session/session_table.hpp"
#include "server/subscription/subscription_table.hpp"
#include "server/users/login_guard.hpp"
#include "server/users/password_checks.hpp"

namespace busbar::server::detail {

/// What all connections and services of one server share.
struct Core {
    /// A log that is as bounded as log().
    struct Rationed final : LogSink {
        explicit Rationed(Core& c) : core{c} {}
        void write(LogLevel level, std::string_view source, std::string_view text) override
        {
            core.log(level, source, text);
        }
        Core& core;
    };

    Core(ServerConfig c, const ServerEnvironment& e, model::AddressSpace space);

    ServerConfig config;
    Rationed rationed_log{*this};
    Guards guards;
    /// The guarded one: nothing in it throws.
    ServerEnvironment environment;
    model::AddressSpace address_space;
    model::DataTypes data_types;
    binary::TypeRegistry types;
    Diagnostics diagnostics;
    DataSources sources;
    /// Outlives the items that take part in it.
    Events events;
    ModelChanges model_changes;
    ClientNodes client_nodes;
    channel::AssemblyBudget assembly;
    SessionTable sessions;
    SessionNodes session_nodes;
    Subscriptions subscriptions;
    LoginGuard logins;
    PasswordChecks password_checks{environment.waker};
    crypto::CertificateWatch certificate_watch;
    /// When the server's certificate is looked at again.
    TimePoint certificate_check{no_deadline};
    /// All connections, oldest first, which is by id.
    std::vector<Link*> links;
    /// Those with operations that have answered and can be destroyed, each once.
    std::vector<Link*> to_sweep;
    /// Ids of connections with news for whoever drives them.
    std::deque<std::uint64_t> changed;
    std::uint64_t next_link_id{1};
    /// Of the next channel; begins at a random number (Part 6, 6.7.2.2).
    std::uint32_t next_channel_id{1};

    /// Index of the ApplicationUri in the NamespaceArray.
    std::uint16_t own_namespace{1};
    DateTime start_time;
    ServerState state{ServerState::Running};
    std::string shutdown_reason;
    DateTime shutdown_time;
    TimePoint shutdown_deadline{no_deadline};

    [[nodiscard]] const ServerLimits& limits() const { return config.limits; }
    [[nodiscard]] bool is_shutting_down() const { return state == ServerState::Shutdown; }
    /// Only so many lines a minute: what peers cause must not fill a disk (Part 2, 5.1.2.3).
    void log(LogLevel level, std::string_view source, std::string_view text);
    /// Null if it has gone.
    [[nodiscard]] Link* find_link(std::uint64_t link_id) const;
    /// To be called at the end of whatever is called from outside.
    void sweep();
    /// Says what the operator should know of the server's own certificate (see
    /// certificate_notices).
    void watch_certificate(TimePoint now);
    /// Ends what the session has pending with `status`, then the session itself. Its Subscriptions
    /// live on, for another session to take over, unless they are to be deleted with it.
    void close_session(Session& session, StatusCode status, bool deletes_subscriptions = false);

private:
    std::int64_t log_minute_{0};
    std::size_t log_lines_{0};
};

} // namespace busbar::server::detail
