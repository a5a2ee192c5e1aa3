#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include <busbar/channel/spare_buffers.hpp>
#include <busbar/crypto/certificate_notices.hpp>
#include <busbar/server/modules.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/enumerations.hpp>

#include "channel_guard.hpp"
#include "core/kept_memory.hpp"
#include "parts.hpp"
#include "server/attribute/attribute_needs.hpp"
#include "server/data/data_sources.hpp"
#include "server/diagnostics/server_object.hpp"
#include "server/method/method_needs.hpp"
#include "server/node_management/node_management_needs.hpp"
#include "server/session/session_needs.hpp"
#include "server/subscription/subscription_needs.hpp"
#include "server/subscription/subscription_table.hpp"
#include "server/users/guards.hpp"
#include "server/view/view_context.hpp"
#include "service_table.hpp"

namespace busbar::server {
class CountdownHeir;
}

namespace busbar::server::detail {

class PeerLink;

/// All parts of one server, and the ports by which they reach each other. No lower floor knows it.
struct Core : private SessionKeeper, private WriteObserver, private ModelObserver {
    /// A log that is rationed like log().
    struct Rationed final : LogSink {
        explicit Rationed(Core& c) : core{c} {}
        void write(LogLevel level, std::string_view source, std::string_view text) override
        {
            core.log(level, source, text);
        }
        void record(const Record& record) override { core.environment.log->record(record); }
        [[nodiscard]] bool wants(RecordKind kind) const override
        {
            return core.environment.log->wants(kind);
        }
        Core& core;
    };

    /// `own` is the index of the ApplicationUri in the NamespaceArray.
    Core(ServerConfig c, const ServerEnvironment& e, model::AddressSpace space, std::uint16_t own);
    Core(const Core&) = delete;
    Core& operator=(const Core&) = delete;
    virtual ~Core() = default;

    /// Adds the server's modules; called once, before anything else.
    void add(ModuleTable modules);

    ServerConfig config;
    Rationed rationed_log{*this};
    Guards guards;
    /// The guarded environment: nothing in it throws.
    ServerEnvironment environment;
    std::uint16_t own_namespace;
    ServerLife life;
    model::AddressSpace address_space;
    binary::TypeRegistry types;
    Counters counters;
    /// Assessed when the server was created or, later, started.
    Conformance conformance;
    /// Null without the module.
    Conformance (*assess_all)(const Core& core){nullptr};
    /// Memory for decoded requests and their results.
    busbar::detail::KeptMemory kept_memory;
    DataSources sources;
    ServiceTable services;
    /// Outlives the items that are registered with it.
    std::unique_ptr<EventPart> events{std::make_unique<EventPart>()};
    channel::AssemblyBudget assembly;
    /// Outlives the connections.
    channel::SpareBuffers spares;
    crypto::KnownCertificates known_certificates;
    SessionTable sessions;
    LoginGuard logins;
    ChannelGuard channel_guard;
    PasswordChecks password_checks{environment.waker};
    WorkQueue channel_work{environment.waker};

    // The needs of each service set.

    const DiagnosticsNeeds diagnostics_needs;
    ServerObject server_object{diagnostics_needs};
    SubscriptionNeeds subscription_needs;
    SubscriptionTable subscriptions{subscription_needs};
    SessionNeeds session_needs;
    AttributeNeeds attribute_needs;
    /// Null without a module that has some.
    LateNodes* late_nodes{nullptr};
    const ViewNeeds view_needs;

    // Parts of modules.

    std::unique_ptr<DiagnosticsPart> diagnostics{std::make_unique<DiagnosticsPart>()};
    std::unique_ptr<ModulePart> methods;
    std::unique_ptr<ModulePart> node_management;

    crypto::CertificateWatch certificate_watch;
    /// The time of the next check of the server's certificate.
    TimePoint certificate_check{no_deadline};
    /// All connections, oldest first, which is the order of ids.
    std::vector<PeerLink*> links;
    /// Connections with operations that have answered and can be destroyed, each once.
    std::vector<PeerLink*> to_sweep;
    /// Connections with changes for the driver, each once.
    std::list<PeerLink*> changed;
    std::uint64_t next_link_id{1};
    /// Id of the next channel; begins at a random number (Part 6, 6.7.2.2).
    std::uint32_t next_channel_id{1};

    /// The time of the last call of the server.
    TimePoint latest{};
    TimePoint shutdown_deadline{no_deadline};
    /// Set during a shutdown that can be cancelled until its end; else null.
    CountdownHeir* countdown_heir{nullptr};
    /// Due work has failed: it is repeated at this time, and not before.
    TimePoint retry{TimePoint::min()};
    /// The time when channels that were opened with another certificate are closed: those of links
    /// before this one.
    TimePoint old_channels_deadline{no_deadline};
    std::uint64_t first_new_link_id{0};
    /// The time when the clients' certificates are checked again.
    TimePoint trust_check_deadline{no_deadline};
    /// The time when sessions are ended whose endpoint has gone: the next deadline, so that a
    /// request that takes its own endpoint away is answered.
    TimePoint homeless_deadline{no_deadline};

    /// The maximum size of kept_memory.
    [[nodiscard]] static std::size_t kept_bytes(const ServerLimits& limits);
    [[nodiscard]] const ServerLimits& limits() const { return config.limits; }
    [[nodiscard]] bool is_shutting_down() const { return life.is_shutting_down(); }
    /// Limits the lines a minute: messages that peers cause must not fill a disk (Part 2, 5.1.2.3).
    void log(LogLevel level, std::string_view source, std::string_view text);
    /// Closes connections whose unfinished messages leave too little for others' (see
    /// ServerLimits::max_assembly), because of input from `taker`.
    void relieve_assembly(std::string_view taker);
    /// Returns null if it was closed.
    [[nodiscard]] PeerLink* find_link(std::uint64_t link_id) const;
    /// Call at the end of every public entry point.
    void sweep();
    /// Assesses the server's conformance again.
    void claim();
    /// Returns the observer of node management.
    [[nodiscard]] ModelObserver& model_observer() { return *this; }
    /// Reports what the operator should know about the server's own certificate (see
    /// certificate_notices).
    void watch_certificate(TimePoint now);

    // SessionKeeper.

    void close_session(Session& session, StatusCode status, bool deletes_subscriptions) override;
    void session_activated(Session& session) override;
    void user_changed(Session& session, TimePoint now) override;
    [[nodiscard]] std::uint32_t cancel(const Session& session,
                                       std::uint32_t request_handle) override;

private:
    void kept_values_written() override;
    [[nodiscard]] bool wants_node_ids() const override;
    void written(const Session* session, const RequestMark& mark, const WriteRequest& request,
                 std::span<const model::NodeHandle> nodes,
                 FunctionRef<StatusCode(std::size_t)> result) override;
    void given_up(const Session& session, const RequestMark& mark, const WriteRequest& request,
                  std::span<const model::NodeHandle> nodes,
                  FunctionRef<StatusCode(std::size_t)> result) override;
    void announce_semantics(const WriteRequest& request, std::span<const model::NodeHandle> nodes,
                            FunctionRef<StatusCode(std::size_t)> result);
    void model_changed() override;

    std::int64_t log_minute_{0};
    std::size_t log_lines_{0};
};

} // namespace busbar::server::detail
