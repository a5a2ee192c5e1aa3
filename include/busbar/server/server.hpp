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
/// One thread owns a server with all its connections. Whoever drives it calls handle_deadline when
/// next_deadline() has come and handle_completions when the Waker was called, and then sends the
/// output of the connections that next_changed() names.
class BUSBAR_API Server {
public:
    /// Refused, with the reason in the log too, if `environment` lacks what is required or `config`
    /// contradicts itself, as check_config finds without making a server; or if there is no room
    /// for one more namespace.
    [[nodiscard]] static Configured<Server> create(ServerConfig config,
                                                   const ServerEnvironment& environment,
                                                   model::AddressSpace address_space = {});
    /// A server with these modules only; also refused if `config` asks for what others have.
    [[nodiscard]] static Configured<Server> create(ModuleTable modules, ServerConfig config,
                                                   const ServerEnvironment& environment,
                                                   model::AddressSpace address_space = {});
    /// What peers can make a server with these limits hold; see the function of that name.
    [[nodiscard]] static WorstCaseMemory worst_case_memory(const ServerLimits& limits);
    Server(Server&&) noexcept;
    Server& operator=(Server&&) noexcept;
    /// All Connections must have been destroyed.
    ~Server();

    [[nodiscard]] const ServerConfig& config() const;
    /// Which profiles of Part 7 it meets, and why not others; made anew by start().
    [[nodiscard]] const Conformance& conformance() const;
    /// May be changed between calls of other members. Clients are told of nodes and references that
    /// come and go by a GeneralModelChangeEvent where these have a Property NodeVersion (Part 3,
    /// 9.32.2), which the server counts up; until that is done next_deadline() is in the past.
    [[nodiscard]] model::AddressSpace& address_space();
    /// Sets what Server.Namespaces says of a namespace, which it lists without this. Bad_NotFound
    /// for an unknown index; Bad_NotSupported if namespace 0 cannot show it: rights count even so.
    Result<void> describe_namespace(std::uint16_t index, const NamespaceMetadata& metadata);
    /// Types that values may have beyond those of namespace 0; fill it before clients connect.
    [[nodiscard]] binary::TypeRegistry& types();
    /// The source's index, which nodes carry. The source may be destroyed before the server, on the
    /// server's thread: see DataSource.
    std::uint32_t add_source(DataSource& source);
    /// The same with one, not null, that the server keeps alive: for what other threads may let go.
    std::uint32_t add_source(std::shared_ptr<DataSource> source);

    /// Raises an event, from any thread; see EventQueue::raise. False without modules::events.
    bool raise_event(Event event);
    /// For threads that may outlive the server. Null without modules::events.
    [[nodiscard]] std::shared_ptr<EventQueue> event_queue() const;

    /// A connection for a peer that has connected, or that was connected to (see
    /// Connection::reverse_hello). Failed logins are counted by `peer_address`, which has no port.
    /// Bad_TcpServerTooBusy if there is no room, Bad_OutOfMemory; then just close the socket.
    [[nodiscard]] Result<Connection> connect(std::string_view peer_address, TimePoint now);

    /// Begins what needs the time but no client: notices before the server's certificate expires,
    /// on the day, and of host names that it does not have. Call it once, before all else.
    void start(TimePoint now);
    [[nodiscard]] TimePoint next_deadline() const;
    void handle_deadline(TimePoint now);
    /// Answers the requests whose data has arrived and passes on events that were raised.
    void handle_completions(TimePoint now);
    /// The id of a connection that got output or an earlier deadline, or ended, for another reason
    /// than a call of its own members. Each is named once, however much changed.
    [[nodiscard]] std::optional<std::uint64_t> next_changed();

    /// Sets State Shutdown, raises a SystemStatusChangeEvent, and answers all but Read, Publish and
    /// CloseSession with Bad_Shutdown; ServerConfig::shutdown_delay later closes all connections.
    void begin_shutdown(TimePoint now, std::string_view reason);
    /// True once shutdown is over, earlier if nobody is connected: nothing more will be sent.
    [[nodiscard]] bool is_stopped() const;

    /// Reports the next sample of each item of the Variable's value with the SemanticsChanged bit
    /// (Part 8, 5.2) and raises a SemanticChangeEvent: call it when EURange, EngineeringUnits or
    /// the like have changed. What clients write into such Properties is announced without it.
    void announce_semantics_change(const NodeId& variable);
    /// The same with the StructureChanged bit (Part 4, 7.38.1).
    void announce_structure_change(const NodeId& variable);
    /// Call it when the AccessControl decides otherwise than before: what MonitoredItems may see is
    /// checked again, and an item that lost or regained its rights reports that (Part 4, 5.13.2.1).
    /// Requests ask each time in any case.
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
