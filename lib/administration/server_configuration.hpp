#pragma once

#include <deque>
#include <functional>
#include <string>

#include <busbar/server/server.hpp>
#include <busbar/server/worker.hpp>

#include "node_table.hpp"
#include "own_certificate_methods.hpp"
#include "transaction.hpp"
#include "trust_list_file.hpp"

namespace busbar::administration::detail {

/// The ServerConfiguration object (Part 12, 7.10) with its CertificateGroups.
class ServerConfiguration {
public:
    /// `worker` generates keys; if null, the server's thread does.
    ServerConfiguration(server::Server& server, const ManagedCertificates& files, NodeTable& table,
                        const WallClock& clock, LogSink& log, server::Worker* worker,
                        const std::function<bool()>& is_in_setup);

    /// Connects the nodes; the problem names what is missing in namespace 0, or comes from
    /// finish_changes.
    [[nodiscard]] Configured<void> attach();

private:
    using Method = void (ServerConfiguration::*)(server::MethodCall);
    using OwnMethod = void (OwnCertificateMethods::*)(server::MethodCall);

    [[nodiscard]] Configured<void> add_nodes();
    /// A Method that the type has as an optional one, and its NodeIds.
    struct StandardMethod {
        const char* name;
        std::uint32_t declaration;
        std::uint32_t instance;
    };

    [[nodiscard]] Configured<void> add_method(const StandardMethod& what, OwnMethod method);
    void bind(std::uint32_t node, Method method);
    void bind_own(model::NodeIndex node, OwnMethod method);
    void bind_values();
    void bind_diagnostics();
    /// Adds RemoveRejectedCertificate, which is not part of the standard.
    [[nodiscard]] Configured<void> add_remove_rejected();
    /// Adds InApplicationSetup, which is optional in the type.
    [[nodiscard]] Configured<void> add_setup();
    void add_group(std::uint32_t group, crypto::CertificateStore& store, std::string folder,
                   crypto::CertificatePurpose purpose);

    void get_rejected_list(server::MethodCall call);
    void remove_rejected(server::MethodCall call);
    void apply_changes(server::MethodCall call);
    void cancel_changes(server::MethodCall call);

    void trust_changed(std::size_t group);
    void renew(const crypto::OwnCertificate& own);
    void tell_applied(const server::MethodCall& call, const Transaction::Changed& changed);
    void refuse_call(server::MethodCall& call, RecordKind kind, const Refusal& refusal);
    void expire();

    server::Server& server_;
    model::AddressSpace& space_;
    const ManagedCertificates& files_;
    NodeTable& table_;
    const WallClock& clock_;
    LogSink& log_;
    const std::function<bool()>& is_in_setup_;
    Transaction transaction_;
    OwnCertificateMethods own_;
    /// One list for each group.
    std::deque<TrustListFile> trust_lists_;
};

} // namespace busbar::administration::detail
