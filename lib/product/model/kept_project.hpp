#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <busbar/administration/setting_list.hpp>
#include <busbar/backend/label_backend.hpp>
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

/// The project of a server in model mode, which lies in a folder of its own (SH-082679, 9.3), and
/// what is made of it. On the server's thread.
class KeptProject {
public:
    /// Reads the project; there may be none yet. One that cannot be read any more is told by
    /// publish(), and another one can be written. `folder` is made when it is needed. `other` is
    /// the file of a project that is served instead of one that cannot be read, or instead of any
    /// if `takes_other`; empty: there is none. `running` is served from this folder, or null: what
    /// it has is not read again.
    explicit KeptProject(const std::string& folder, const std::string& other = {},
                         bool takes_other = false, const KeptProject* running = nullptr);

    /// Has the configuration say what the project says: its first listener for data, host name,
    /// users, security, certificate subject and discovery server; but for what `changes`, made
    /// online, have said.
    void apply(ControllerConfig& config, const administration::SettingValues& changes) const;
    /// Adds the models' nodes to the server, and the Object "Module" with OperationMode and Version
    /// (SH-082679, 9.14); logs what there is to say. Throws ConfigError. Any thread.
    [[nodiscard]] PublishedProject publish(server::Server& server, const std::string& version,
                                           LogSink& log) const;
    /// The one that is served; null if there is none yet. Another one that is written meanwhile
    /// waits for the next KeptProject.
    [[nodiscard]] const controller::Project* project() const { return served_.get(); }
    /// Its file; empty if there is none.
    [[nodiscard]] const std::string& document() const;
    /// Whether it is that of `last`, the file of the project that was served before, or none.
    [[nodiscard]] bool is_known(const std::string& last) const
    {
        return served_ == nullptr || document() == last;
    }
    /// Whether its labels can be used with the PLC (see check_usable), if nobody has accepted it
    /// all the same. Like publish() on any thread, one at a time.
    [[nodiscard]] Configured<void> check_labels(const backend::LabelBackend& plc,
                                                bool isolates_failures) const;
    /// What its transfers need; all must outlive the server.
    struct TransferNeeds {
        const server::Server& server;
        std::string version;
        LogSink& log;
        /// Of the PLC.
        std::shared_ptr<const backend::LabelBackend> labels;
        bool isolates_failures;
        std::function<Configured<void>()> restart;
    };
    /// For AdministrationParts::file_transfers; once.
    [[nodiscard]] administration::TemporaryFileTransfer transfer(TransferNeeds needs);

private:
    /// Keeps that the project of the store counts whatever its labels are.
    [[nodiscard]] Configured<void> accept_labels();

    mutable storage::FolderStorage files_;
    controller::ProjectStore store_;
    Configured<void> recovered_;
    std::shared_ptr<const controller::Project> served_;
    /// Of served_, once it was asked for.
    mutable std::shared_ptr<const std::string> document_;
    /// Another one is in the store than is served.
    bool is_other_due_{false};
    std::optional<ProjectService> service_;
};

} // namespace busbar::product
