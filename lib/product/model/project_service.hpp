#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/administration/file_transfer.hpp>
#include <busbar/controller/label_check.hpp>
#include <busbar/controller/project_compare.hpp>
#include <busbar/controller/project_store.hpp>
#include <busbar/core/log.hpp>

#include "product/access/reporting_owner.hpp"

namespace busbar::product {

/// The project of model mode over OPC UA (SH-082679, 9.13 and 9.14): the Object "Project" below
/// Objects, a TemporaryFileTransferType. Its generateOptions are null for GenerateFileForRead of
/// the project file, and else one of these texts:
///
///     GenerateFileForRead   "report": the result of the session's last CloseAndCommit
///                           "status": operation mode, server status and version
///     GenerateFileForWrite  "write"    a project file follows
///                           "verify"   a project file follows
///                           "labels"   an empty file follows: the labels of the project that was
///                                      written are compared with the PLC
///                           "update"   an empty file follows: the server takes up its project,
///                                      unless labels of it cannot be used with the PLC
///                           "update despite labels"
///                                      all the same
///
/// A report is JSON: {"problem": "project:12: [network] ..."} for what was refused;
/// {"written": true}; {"updated": true}; {"differences": [{"where", "file", "server"}]} for a
/// verification; and see labels_report(). A status is JSON, too: {"operationMode", "serverStatus",
/// "version", "project"}.
///
/// If two tools write at once, the second is refused. Stop and restart are RequestServerStateChange
/// of the Server. Used on the server's thread; checking and comparing projects runs on the worker,
/// so that other clients are served in the meantime.
class ProjectService final : public ReportingOwner {
public:
    /// The parts of the status that only the program knows.
    struct ModuleStatus {
        std::string operation_mode; // "model mode"
        std::string server_status;  // "Running"
        std::string version;
    };
    /// All members must outlive this object.
    struct Needs {
        controller::ProjectStore& store;
        LogSink& log;
        std::function<ModuleStatus()> status;
        /// Makes the server use the project in the store, which another ProjectService then serves.
        /// The client has not been answered yet; a problem tells why it would not work.
        std::function<Configured<void>()> update;
        /// True if the store has another project than the one that runs.
        bool is_update_due{false};
        /// The reason if the project of the store cannot be read; empty if it can, or there is
        /// none.
        std::string damage{};
        /// The project that runs instead; null for none.
        const controller::Project* served{nullptr};
        /// Labels of the PLC; if null, nothing is compared.
        std::shared_ptr<const backend::LabelBackend> labels{};
        /// True if a label that cannot be used affects only its nodes.
        bool isolates_failures{false};
        /// Accepts the project of the store despite its labels.
        std::function<Configured<void>()> accept_labels{};
    };

    explicit ProjectService(Needs needs);

    /// Returns the transfer for AdministrationParts::file_transfers, which belongs to
    /// SecurityAdmin.
    [[nodiscard]] administration::TemporaryFileTransfer transfer();

    [[nodiscard]] Result<std::vector<std::byte>>
    generate(const administration::TransferRequest& request, std::size_t max_size) override;
    [[nodiscard]] StatusCode may_take(const administration::TransferRequest& request) override;
    [[nodiscard]] StatusCode take(const administration::TransferRequest& request,
                                  std::span<const std::byte> bytes) override;
    [[nodiscard]] std::function<void()> preparation(const administration::TransferRequest& request,
                                                    std::span<const std::byte> bytes) override;

private:
    [[nodiscard]] Configured<std::string> document() const;
    [[nodiscard]] std::string status_text() const;
    [[nodiscard]] std::string project_state() const;
    /// Moves the staged project into the store.
    [[nodiscard]] Configured<std::string> write(std::span<const std::byte> bytes);
    [[nodiscard]] Configured<std::string> update(std::span<const std::byte> bytes,
                                                 bool despite_labels);
    [[nodiscard]] Configured<std::vector<controller::LabelDifference>> compare_labels() const;
    [[nodiscard]] Configured<void> take_labels(bool despite_labels);

    Needs needs_;
    // What preparation() leaves for take().
    std::optional<Configured<controller::ProjectStore::Staged>> staged_;
    Configured<std::string> differences_;
    Configured<std::vector<controller::LabelDifference>> labels_;
};

} // namespace busbar::product
