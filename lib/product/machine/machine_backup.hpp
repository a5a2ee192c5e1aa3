#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <busbar/administration/file_transfer.hpp>
#include <busbar/controller/backup.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/storage_gate.hpp>

#include "product/access/reporting_owner.hpp"

namespace busbar::product {

/// Backup, restore, verification and Clear All Memory of a machine over OPC UA (W588, 8-2 and
/// 8-3): the Object "Backup" below Objects, a TemporaryFileTransferType. Its generateOptions are
/// null for GenerateFileForRead of a backup file, and else one of these texts:
///
///     GenerateFileForRead   "backup without security profile": to be given away
///                           "report": the result of the session's last CloseAndCommit
///     GenerateFileForWrite  "restore"                          a backup file follows
///                           "restore without security profile"
///                           "restore by command\n" and what is in a RestoreCommand.ini, of which
///                               OpcuaSPF decides (W588, 8-2-2): a backup file follows
///                           "restore by variable": restore_target_variable of the program
///                               decides (W588, A-4): a backup file follows
///                           "verify"                           a backup file follows
///                           "verify without security profile"
///                           "clear"                            an empty file follows
///                           "clear with security"              certificate and profile, too
///
/// A report is JSON: {"problem": "backup: found ..."} for what was refused; {"restored": true}, or
/// false for a file of a controller without OPC UA server, with "security_profile": false if that
/// was to be restored and the file has none, and with the variable if that has decided;
/// {"cleared": true}; and
/// {"items": [{"name": "Users", "differences": ["users.json"]}]} for a verification.
///
/// After a restore or a clearing a restart is due. Until then the machine's memory does not change:
/// requests that would change it, including another restore or clearing, answer Bad_InvalidState.
/// Clear All Memory requires PROGRAM mode, and answers Bad_InvalidState in RUN (W588, 8-3).
///
/// Records of settings, users, roles, trust lists and certificates tell what a restore or a
/// clearing has replaced. The Method has one audit event, trust lists have another one (Part 12,
/// 7.8.2.13).
///
/// After a power cut administration::finish_changes, which owns the transaction, finishes it at the
/// next start. Used on the server's thread.
class MachineBackup final : public ReportingOwner {
public:
    /// All members must outlive this object.
    struct Needs {
        /// The storage below the gate, and the event log: a MachineFiles.
        Storage& files;
        /// The gate for all other changes of those files.
        StorageGate& gate;
        std::vector<controller::MemoryItem> items;
        /// Work for another thread before a backup is restored; may be null.
        std::function<std::function<void()>(std::span<const std::byte> backup)> preparation{};
        /// The controller's name in backup files.
        std::string controller;
        const WallClock& clock;
        LogSink& log;
        std::function<controller::MachineMode()> mode;
        /// The value of the program's restore_target_variable.
        std::function<bool()> restores_profile;
        /// Runs its argument while the files of the event log and of RETAIN values do not change.
        std::function<void(FunctionRef<void()>)> hold_files;
        /// Called within that when the RETAIN values were replaced.
        std::function<void()> values_replaced;
        /// Called when the server must stop and a restart is due (W588, 4-1-3 and 4-1-4). The
        /// client has not been answered yet.
        std::function<void()> replaced;
    };

    explicit MachineBackup(Needs needs);

    /// Returns the transfer for AdministrationParts::file_transfers. It belongs to SecurityAdmin,
    /// the administrator of W588, 8-1, because only that role may change certificates and security
    /// settings.
    [[nodiscard]] administration::TemporaryFileTransfer transfer();

    [[nodiscard]] Result<std::vector<std::byte>>
    generate(const administration::TransferRequest& request, std::size_t max_size) override;
    [[nodiscard]] StatusCode may_take(const administration::TransferRequest& request) override;
    [[nodiscard]] StatusCode take(const administration::TransferRequest& request,
                                  std::span<const std::byte> bytes) override;
    [[nodiscard]] std::function<void()> preparation(const administration::TransferRequest& request,
                                                    std::span<const std::byte> bytes) override;

private:
    struct Wish;
    [[nodiscard]] static Configured<Wish> wish_of(const Variant& options);
    [[nodiscard]] Result<std::vector<std::byte>>
    make_backup(const controller::BackupChoice& choice);
    [[nodiscard]] Configured<std::string> carry_out(Wish& wish, std::span<const std::byte> bytes);
    [[nodiscard]] Configured<std::string> restore(Wish& wish, std::span<const std::byte> bytes);
    [[nodiscard]] Configured<std::string> verify(const Wish& wish,
                                                 std::span<const std::byte> bytes) const;
    [[nodiscard]] Configured<std::string> clear(const Wish& wish);
    void values_replaced() const;
    void tell_replaced(const administration::TransferRequest& request, bool with_security) const;

    Needs needs_;
    controller::MachineMemory memory_;
};

} // namespace busbar::product
