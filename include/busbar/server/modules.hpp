#pragma once

#include <span>
#include <string_view>

#include <busbar/core/api.hpp>

/// Parts of a server that not every program needs, and tables of them for Server::create. A part
/// that no table of a program names is not linked into it, if the linker removes unused sections
/// (-Wl,--gc-sections); benchmarks/size shows the effect.
///
/// Every server has Discovery, sessions with anonymous users, passwords and certificates, Read,
/// Write, Browse and the other View services, Subscriptions with items of values, and the Server
/// object with status and capabilities.
namespace busbar::server {

namespace detail {
struct Core;
} // namespace detail

/// One such part: one of those in `modules`. Its members are private to the server.
struct Module {
    /// Its name in `modules`, for messages.
    std::string_view name;
    void (*add_to)(detail::Core& core);
};

/// In any order, each at most once. Used while a server is created.
using ModuleTable = std::span<const Module* const>;

namespace modules {

/// Call (Part 4, 5.12); GetMonitoredItems and ResendData of the Server object (Part 5, 9.1 and
/// 9.2).
extern BUSBAR_API const Module methods;
/// SetTriggering (Part 4, 5.13.5).
extern BUSBAR_API const Module triggering;
/// TransferSubscriptions (Part 4, 5.14.7).
extern BUSBAR_API const Module transfer;
/// Items of events with their filters (Part 4, 7.22.3), Server::raise_event, and events about nodes
/// that are added and removed. Without it a node's events answer Bad_NotSupported.
extern BUSBAR_API const Module events;
/// ServerDiagnostics and the nodes of sessions (Part 5, 6.3.3 to 6.3.5).
extern BUSBAR_API const Module diagnostics;
/// The NodeManagement services (Part 4, 5.8); see ServerConfig::has_node_management.
extern BUSBAR_API const Module node_management;
/// Users with JSON Web Tokens (Part 6, 6.5.2); see EndpointConfig::allows_issued.
extern BUSBAR_API const Module issued_tokens;
/// Written values are checked by their DataTypeDefinitions: structures without a generated type,
/// and numbers of enumerations. Without it they are accepted unchecked.
extern BUSBAR_API const Module definition_checks;
/// Assesses which profiles and units of Part 7 the server meets (Server::conformance,
/// ServerProfileArray, ConformanceUnits). Without it a server claims its transport and nothing
/// else.
extern BUSBAR_API const Module conformance;
/// All structures of namespace 0 in values that clients send. Without it only those that the other
/// parts need are known, and the types in Server::types(); others stay encoded.
extern BUSBAR_API const Module all_types;

} // namespace modules

/// No modules: for Micro Embedded Device 2017 (Part 7, 6.6.67).
[[nodiscard]] BUSBAR_API ModuleTable micro_modules();
/// Methods, triggering and definition checks, for Embedded 2017 UA Server (Part 7, 6.6.69).
[[nodiscard]] BUSBAR_API ModuleTable embedded_modules();
/// These and transfer, events, diagnostics and conformance, for Standard 2017 UA Server (Part 7,
/// 6.6.71).
[[nodiscard]] BUSBAR_API ModuleTable standard_modules();
/// All modules.
[[nodiscard]] BUSBAR_API ModuleTable full_modules();

} // namespace busbar::server
