#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include <busbar/binary/type_registry.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/connection.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/environment.hpp>
#include <busbar/server/event.hpp>
#include <busbar/server/modules.hpp>
#include <busbar/server/namespace_metadata.hpp>
#include <busbar/server/sampling_state.hpp>
#include <busbar/server/server_config.hpp>

namespace busbar::server {

struct Conformance;
struct WorstCaseMemory;

/// One OPC UA server: address space, data sources and sessions, to which Connections bring the
/// clients. Does no I/O; any number of them live in one process.
///
/// One thread owns a server with all its connections. The program that drives it calls
/// handle_deadline at next_deadline() and handle_completions after the Waker was called, and then
/// sends the output of the connections that next_changed() names.
class BUSBAR_API Server {
public:
    /// Fails, with the reason in the log too, if `environment` lacks a required field or `config`
    /// contradicts itself, as check_config finds without creating a server; or if there is no room
    /// for one more namespace.
    [[nodiscard]] static Configured<Server> create(ServerConfig config,
                                                   const ServerEnvironment& environment,
                                                   model::AddressSpace address_space = {});
    /// Creates a server with these modules only; also fails if `config` needs other ones.
    [[nodiscard]] static Configured<Server> create(ModuleTable modules, ServerConfig config,
                                                   const ServerEnvironment& environment,
                                                   model::AddressSpace address_space = {});
    /// Returns what peers can make a server with these limits hold; see the function of that name.
    [[nodiscard]] static WorstCaseMemory worst_case_memory(const ServerLimits& limits);
    Server(Server&&) noexcept;
    Server& operator=(Server&&) noexcept;
    /// All Connections must have been destroyed.
    ~Server();

    [[nodiscard]] const ServerConfig& config() const;
    /// The profiles of Part 7 that it meets, and why not others; assessed again by start().
    [[nodiscard]] const Conformance& conformance() const;
    /// May be changed between calls of other members. Clients learn of nodes and references that
    /// are added or removed by a GeneralModelChangeEvent if the nodes have a NodeVersion (Part 3,
    /// 9.32.2), which the server increments; until then next_deadline() is in the past.
    [[nodiscard]] model::AddressSpace& address_space();
    /// Sets the properties of a namespace in Server.Namespaces. Bad_NotFound for an unknown index;
    /// Bad_NotSupported if namespace 0 cannot show it: rights apply nevertheless.
    Result<void> describe_namespace(std::uint16_t index, const NamespaceMetadata& metadata);
    /// Types of values in addition to those of namespace 0; fill it before clients connect.
    [[nodiscard]] binary::TypeRegistry& types();
    /// Returns the source's index, which nodes refer to. The source may be destroyed before the
    /// server, on the server's thread: see DataSource.
    std::uint32_t add_source(DataSource& source);
    /// Adds one, not null, that the server keeps alive: for sources that other threads may release.
    std::uint32_t add_source(std::shared_ptr<DataSource> source);

    /// Raises an event, from any thread; see EventQueue::raise. False without modules::events.
    bool raise_event(Event event);
    /// For threads that may outlive the server. Null without modules::events.
    [[nodiscard]] std::shared_ptr<EventQueue> event_queue() const;

    /// Returns a connection for a peer that has connected, or that was connected to (see
    /// Connection::reverse_hello). Failed logins are counted by `peer_address`, which has no port.
    /// Bad_TcpServerTooBusy if there is no room, Bad_OutOfMemory; then just close the socket.
    [[nodiscard]] Result<Connection> connect(std::string_view peer_address, TimePoint now);

    /// Starts what needs the time but no client: notices before the server's certificate expires,
    /// on the day, and about host names that it lacks. Call it once, before all other functions.
    void start(TimePoint now);
    [[nodiscard]] TimePoint next_deadline() const;
    void handle_deadline(TimePoint now);
    /// Answers the requests whose data has arrived and delivers events that were raised.
    void handle_completions(TimePoint now);
    /// Returns the id of a connection that got output or an earlier deadline, or ended, for another
    /// reason than a call of its own members. Each is named once, however much changed.
    [[nodiscard]] std::optional<std::uint64_t> next_changed();

    /// Sets State Shutdown, raises a SystemStatusChangeEvent, and answers all but Read, Publish and
    /// CloseSession with Bad_Shutdown; ServerConfig::shutdown_delay later closes all connections.
    void begin_shutdown(TimePoint now, std::string_view reason);
    /// True once shutdown is over, earlier if no client is connected: nothing more will be sent.
    [[nodiscard]] bool is_stopped() const;

    /// Reports the next sample of each item of the Variable's value with the SemanticsChanged bit
    /// (Part 8, 5.2) and raises a SemanticChangeEvent: call it when EURange, EngineeringUnits or
    /// similar Properties have changed other than by a client's write.
    void announce_semantics_change(const NodeId& variable);
    /// Announces likewise with the StructureChanged bit (Part 4, 7.38.1).
    void announce_structure_change(const NodeId& variable);
    /// Call it when the AccessControl decides differently: an item that lost or regained its rights
    /// reports that (Part 4, 5.13.2.1). Requests ask each time in any case.
    void announce_access_change(TimePoint now);

    [[nodiscard]] SamplingState sampling_state() const;

    [[nodiscard]] std::size_t subscription_count() const;
    [[nodiscard]] std::size_t monitored_item_count() const;
    [[nodiscard]] std::size_t session_count() const;
    [[nodiscard]] std::size_t connection_count() const;

private:
    friend class Connection;
    friend class RunningServer;
    struct Impl;
    explicit Server(std::unique_ptr<Impl> impl);

    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::server
