#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <busbar/administration/setting_list.hpp>
#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_check.hpp>
#include <busbar/controller/mapping.hpp>
#include <busbar/controller/project.hpp>
#include <busbar/controller/project_store.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/server.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "product/configuration/config.hpp"
#include "project_service.hpp"

namespace busbar::product {

/// Lists the labels of a project that the running PLC does not have, or has with another type than
/// their nodes (SH-082679, 8.2 and 8.3). Empty if the PLC must be asked for its labels, which the
/// server does later. Fails if the project's models are not valid. Takes time in proportion to the
/// project; thread-safe.
[[nodiscard]] Configured<std::vector<controller::LabelDifference>>
label_differences(const controller::Project& project, const backend::LabelBackend& plc);

/// Fails with a list of the labels that cannot be used, up to a dozen, with node, expected and
/// found type. Labels whose values are converted within their range can be used.
[[nodiscard]] Configured<void>
check_usable(const std::vector<controller::LabelDifference>& differences);

/// Writes {"labels": [{"node", "part", "label", "expected", "found", "use"}], "labelCount"} with
/// the first 100 labels; "use" is "converted" or "refused".
[[nodiscard]] std::string
labels_report(const std::vector<controller::LabelDifference>& differences);

/// The published parts of a project.
struct PublishedProject {
    /// Indexed by the server's NodeIds.
    controller::Mapping mapping;
    /// The Object "Module".
    model::NodeIndex module;
};

/// The project of a server in model mode, in a folder of its own (SH-082679, 9.3), and the objects
/// made from it. Used on the server's thread.
class KeptProject {
public:
    /// Reads the project, which need not exist yet. If it cannot be read, publish() reports that,
    /// and another one can be written. `folder` is created when it is needed. `other` is the file
    /// of a project that replaces one that cannot be read, or any if `takes_other`; empty for none.
    /// `running` is the project that is served from this folder, or null; its parts are not read
    /// again.
    explicit KeptProject(const std::string& folder, const std::string& other = {},
                         bool takes_other = false, const KeptProject* running = nullptr);

    /// Applies the project to the configuration: its first listener for data, host name, users,
    /// security, certificate subject and discovery server, except for settings in `changes`, which
    /// were made online.
    void apply(ControllerConfig& config, const administration::SettingValues& changes) const;
    /// Adds the models' nodes to the server, and the Object "Module" with OperationMode and Version
    /// (SH-082679, 9.14); logs notices. Throws ConfigError. Thread-safe.
    [[nodiscard]] PublishedProject publish(server::Server& server, const std::string& version,
                                           LogSink& log) const;
    /// The project that is served; null if there is none yet. A project that is written in the
    /// meantime waits for the next KeptProject.
    [[nodiscard]] const controller::Project* project() const { return served_.get(); }
    /// The version of the project's file in the store; nothing if there is none.
    [[nodiscard]] std::optional<StorageEntry::Version> version() const;
    /// Its file; empty if there is none.
    [[nodiscard]] const std::string& document() const;
    /// The same file while nothing else is served; null if there is none.
    [[nodiscard]] std::shared_ptr<const std::string> shared_document() const
    {
        return document().empty() ? nullptr : document_;
    }
    /// Returns whether it is none, or that of `last`, the file of the project that was served
    /// before.
    [[nodiscard]] bool is_known(const std::string& last) const
    {
        return served_ == nullptr || document() == last;
    }
    /// Checks that its labels can be used with the PLC (see check_usable), if nobody has accepted
    /// it all the same. Like publish() on any thread, one at a time.
    [[nodiscard]] Configured<void> check_labels(const backend::LabelBackend& plc,
                                                bool isolates_failures) const;
    /// The objects that its transfers use; all must outlive the server.
    struct TransferNeeds {
        /// True while an administrator has shut the server down.
        const bool& is_shut_down;
        std::string version;
        LogSink& log;
        /// Labels of the PLC.
        std::shared_ptr<const backend::LabelBackend> labels;
        bool isolates_failures;
        std::function<Configured<void>()> restart;
    };
    /// Returns the transfer for AdministrationParts::file_transfers; call it once.
    [[nodiscard]] administration::TemporaryFileTransfer transfer(TransferNeeds needs);

private:
    /// Stores that the project of the store is accepted despite its labels.
    [[nodiscard]] Configured<void> accept_labels();

    mutable storage::FolderStorage files_;
    controller::ProjectStore store_;
    Configured<void> recovered_;
    std::shared_ptr<const controller::Project> served_;
    /// File of served_, once it was requested.
    mutable std::shared_ptr<const std::string> document_;
    /// Another one is in the store than is served.
    bool is_other_due_{false};
    std::optional<ProjectService> service_;
};

} // namespace busbar::product
