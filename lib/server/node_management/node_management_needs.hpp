#pragma once

#include <busbar/core/log.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/server_config.hpp>

#include "client_nodes.hpp"

namespace busbar::server::detail {

/// Notifies clients of nodes that are added and removed.
class ModelObserver {
public:
    ModelObserver() = default;
    ModelObserver(const ModelObserver&) = delete;
    ModelObserver& operator=(const ModelObserver&) = delete;

    /// A request has added or removed some.
    virtual void model_changed() = 0;

protected:
    ~ModelObserver() = default;
};

/// The needs of the NodeManagement services; valid as long as the server.
struct NodeManagementNeeds {
    model::AddressSpace& space;
    const ServerConfig& config;
    /// May be null.
    const AccessControl* access;
    ClientNodes& client_nodes;
    ModelObserver& observer;
    /// Gets a record of each change; rationed, since peers can cause them.
    LogSink& log;
    /// Index of the ApplicationUri in the NamespaceArray.
    std::uint16_t own_namespace;
};

} // namespace busbar::server::detail
