#pragma once

#include <busbar/core/log.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/server_config.hpp>

#include "client_nodes.hpp"

namespace busbar::server::detail {

/// Who tells clients of nodes that come and go.
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

/// What the NodeManagement services need of the server; as long as that lives.
struct NodeManagementNeeds {
    model::AddressSpace& space;
    const ServerConfig& config;
    /// May be null.
    const AccessControl* access;
    ClientNodes& client_nodes;
    ModelObserver& observer;
    /// Gets a record of each change; as bounded as what peers cause has to be.
    LogSink& log;
    /// Index of the ApplicationUri in the NamespaceArray.
    std::uint16_t own_namespace;
};

} // namespace busbar::server::detail
