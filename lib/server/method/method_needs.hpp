#pragma once

#include <cstddef>
#include <span>

#include <busbar/binary/type_registry.hpp>
#include <busbar/core/log.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/limits.hpp>
#include <busbar/server/method.hpp>
#include <busbar/types/enumerations.hpp>

#include "server/data/data_sources.hpp"
#include "server/session/service.hpp"

namespace busbar::server::detail {

/// Methods of the Server object that the server carries out itself, see is_built_in_method().
class BuiltInMethods {
public:
    BuiltInMethods() = default;
    BuiltInMethods(const BuiltInMethods&) = delete;
    BuiltInMethods& operator=(const BuiltInMethods&) = delete;

    /// `inputs` fit the Method's InputArguments; `item_count` is increased by the monitored items
    /// that it visits.
    [[nodiscard]] virtual CallResult call(const NodeId& method, const ServiceContext& context,
                                          std::span<const Variant> inputs,
                                          std::size_t& item_count) = 0;

protected:
    ~BuiltInMethods() = default;
};

/// The needs of Call; valid as long as the server.
struct MethodNeeds {
    const model::AddressSpace& space;
    DataSources& sources;
    const binary::TypeRegistry& types;
    const ServerLimits& limits;
    /// May be null.
    const AccessControl* access;
    LogSink& log;
    BuiltInMethods& built_in;
    const ServerState& state;
};

} // namespace busbar::server::detail
