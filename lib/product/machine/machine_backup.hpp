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
///                           "report": what the session's last CloseAndCommit came to
///     GenerateFileForWrite  "restore"                          a backup file follows
///                           "restore without security profile"
///                           "restore by command\n" and what is in a RestoreCommand.ini, of which
///                               OpcuaSPF decides (W588, 8-2-2): a backup file follows
///                           "verify"                           a backup file follows
///                           "verify without security profile"
///                           "clear"                            an empty file follows
///                           "clear with security"              certificate and profile, too
///
/// A report is JSON: {"problem": "backup: found ..."} for what was refused; {"restored": true}, or
/// false for a file of a controller without OPC UA server, with "security_profile": false if that
/// was to be restored and the file has none; {"cleared": true}; and
/// {"items": [{"name": "Users", "differences": ["users.json"]}]} for a verification.
///
/// After a restore and after a clearing a restart is due: until then nothing of the machine's
/// memory changes, what would answers Bad_InvalidState, and so do another restore and another
/// clearing. Clear All Memory wants PROGRAM mode, and answers Bad_InvalidState in RUN (W588,
/// 8-3).
///
/// What a restore or a clearing has replaced is told as records of settings, users, roles, trust
/// lists and certificates, of which audit events are made (Part 5, 6.4).
///
/// What a power cut left is finished by administration::finish_changes at the next start, whose
/// transaction it is. On the server's thread.
class MachineBackup final : public ReportingOwner {
public:
    /// All must outlive it.
    struct Needs {
        /// What is behind the gate, and the event log: a MachineFiles.
        Storage& files;
        /// By which everybody else changes those files.
        StorageGate& gate;
        std::vector<controller::MemoryItem> items;
        /// The name that backup files say.
        std::string controller;
        const WallClock& clock;
        LogSink& log;
        std::function<controller::MachineMode()> mode;
        /// Runs its argument while the files of the event log and of RETAIN values stay as they
        /// are.
        std::function<void(FunctionRef<void()>)> hold_files;
        /// Within that: the RETAIN values are others.
        std::function<void()> values_replaced;
        /// The server is to stop, and a restart is due (W588, 4-1-3 and 4-1-4). The client has
        /// no answer yet.
        std::function<void()> replaced;
    };

    explicit MachineBackup(Needs needs);

    /// For AdministrationParts::file_transfers: for SecurityAdmin, the administrator of W588,
    /// 8-1, who alone may change certificates and security settings.
    [[nodiscard]] administration::TemporaryFileTransfer transfer();

    [[nodiscard]] Result<std::vector<std::byte>>
    generate(const administration::TransferRequest& request, std::size_t max_size) override;
    [[nodiscard]] StatusCode may_take(const administration::TransferRequest& request) override;
    [[nodiscard]] StatusCode take(const administration::TransferRequest& request,
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

    Needs needs_;
    controller::MachineMemory memory_;
};

} // namespace busbar::product
