#pragma once

#include <cstdint>
#include <unordered_map>

#include <busbar/core/data_value.hpp>
#include <busbar/core/result.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

struct Core;
struct ValueReader;
class Session;

/// The source of Variables that belong to an Object of SessionNodes. It is none of DataSources.
inline constexpr std::uint32_t session_nodes_source = model::no_source - 1;

/// An Object for each activated session below SessionsDiagnosticsSummary (Part 5, 6.3.4 and 6.3.5):
/// its NodeId is the session's. There are none while diagnostics are off (Part 5, 6.3.3), nor in a
/// namespace 0 without the types.
class SessionNodes {
public:
    /// Does nothing if the session has its Object, or may have none.
    void add(Core& core, const Session& session);
    void remove(Core& core, const Session& session);
    /// Adds or removes the Objects of all sessions if diagnostics were switched on or off.
    void take_flag(Core& core);

    /// The value of a Variable of one of the Objects, by the handle it was given; Bad_NodeIdUnknown
    /// for any other. Not every reader may see the security diagnostics.
    [[nodiscard]] Result<Variant> value(const Core& core, std::uint64_t handle,
                                        const ValueReader& reader) const;

private:
    struct Entry {
        const Session* session;
        model::NodeHandle object;
    };

    std::unordered_map<std::uint32_t, Entry> entries_;
    std::uint32_t last_number_{0};
    bool is_shown_{true};
};

} // namespace busbar::server::detail
