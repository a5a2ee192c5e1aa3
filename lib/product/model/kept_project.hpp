#pragma once

#include <functional>
#include <optional>
#include <string>

#include <busbar/controller/mapping.hpp>
#include <busbar/controller/project_store.hpp>
#include <busbar/server/server.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "product/configuration/config.hpp"
#include "project_service.hpp"

namespace busbar::product {

/// What a server has of a project.
struct PublishedProject {
    /// By the server's NodeIds.
    controller::Mapping mapping;
    /// The Object "Module".
    model::NodeIndex module;
};

/// The project of a server in model mode, which lies in a folder of its own (seed 001, 9.3), and
/// what is made of it. On the server's thread.
class KeptProject {
public:
    /// Reads the project; there may be none yet. One that cannot be read any more is told by
    /// publish(), and another one can be written. `folder` is made when it is needed.
    explicit KeptProject(const std::string& folder);

    /// Has the configuration say what the project says: its first listener for data, host name,
    /// users, security, certificate subject and discovery server. `keeps_port`: but for the port.
    void apply(ControllerConfig& config, bool keeps_port) const;
    /// Adds the models' nodes to the server, and the Object "Module" with OperationMode and Version
    /// (seed 001, 9.14); logs what there is to say. Throws ConfigError.
    [[nodiscard]] PublishedProject publish(server::Server& server, const std::string& version,
                                           LogSink& log) const;
    /// Null if there is none yet.
    [[nodiscard]] const controller::Project* project() const { return store_.current(); }
    /// For AdministrationParts::file_transfers; once. All must outlive the server.
    [[nodiscard]] administration::TemporaryFileTransfer transfer(const server::Server& server,
                                                                 std::string version, LogSink& log,
                                                                 std::function<void()> restart);

private:
    storage::FolderStorage files_;
    controller::ProjectStore store_;
    Configured<void> recovered_;
    std::optional<ProjectService> service_;
};

} // namespace busbar::product
