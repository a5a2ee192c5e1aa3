#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/function_ref.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/limits.hpp>
#include <busbar/types/attribute.hpp>

#include "definition_checks.hpp"
#include "server/data/data_sources.hpp"
#include "server/rights/live_values.hpp"

namespace busbar::server::detail {

class Session;
struct RequestMark;

/// Is notified of what clients write.
class WriteObserver {
public:
    WriteObserver() = default;
    WriteObserver(const WriteObserver&) = delete;
    WriteObserver& operator=(const WriteObserver&) = delete;

    /// Values in the address space may have been replaced.
    virtual void kept_values_written() = 0;
    /// True if the NodeIds of a request must be those of the nodes, since they are recorded.
    [[nodiscard]] virtual bool wants_node_ids() const = 0;
    /// The request was carried out; `nodes` has a place for each item, no_node if there was none,
    /// and `result` returns its result. The session may be null, if it has ended meanwhile.
    virtual void written(const Session* session, const RequestMark& mark,
                         const WriteRequest& request, std::span<const model::NodeHandle> nodes,
                         FunctionRef<StatusCode(std::size_t)> result) = 0;

    /// The client gets no results: the request ended before it was carried out, although values in
    /// the address space may have been replaced. `nodes` is as for written(), no_node also for
    /// items that were not looked at, and `result` returns the result of each item that was carried
    /// out, else why the request ended.
    virtual void given_up(const Session& session, const RequestMark& mark,
                          const WriteRequest& request, std::span<const model::NodeHandle> nodes,
                          FunctionRef<StatusCode(std::size_t)> result) = 0;

protected:
    ~WriteObserver() = default;
};

/// The needs of the Attribute services; valid as long as the server.
struct AttributeNeeds {
    model::AddressSpace& space;
    DataSources& sources;
    std::unique_ptr<DefinitionChecks> definitions;
    const ServerLimits& limits;
    /// May be null.
    const AccessControl* access;
    const WallClock& wall_clock;
    const LiveValues& live_values;
    WriteObserver& observer;
    /// Locales of texts that may be written, in addition to those in the address space.
    const std::vector<std::string>& locale_ids;
    DateTime start_time{};
};

} // namespace busbar::server::detail
