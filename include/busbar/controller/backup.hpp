#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/machine_settings.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>

/// Backup, restore, verification and Clear All Memory (W588, 3-2-9, 8-2 and
/// 8-3).
namespace busbar::controller {

namespace detail {
struct SavedMemory;
} // namespace detail

/// The treatment of data (W588, 3-2-9). Data in none of these groups, such as the
/// execution log, is neither saved nor cleared.
enum class MemoryGroup : std::uint8_t {
    ServerSettings,    // saved, restored, cleared
    RetainedValues,    // saved, restored, cleared; not verified, as they change all the time
    SecurityProfile,   // saved; restored and cleared by choice
    EventLog,          // saved
    ServerCertificate, // belongs to one controller: cleared by choice
};

/// The part that an item has in a file shared by several items, such as settings of two groups in
/// one document. In a backup it is a separate file.
struct FilePart {
    using Bytes = std::vector<std::byte>;

    /// The shared file in the Storage.
    std::string file;
    /// Returns the item's part of `whole`; empty if there is none. The result does not depend on
    /// the other parts, and applied to its own result it returns the same. Without a file `whole`
    /// is empty.
    std::function<Configured<Bytes>(std::span<const std::byte> whole)> take{};
    /// Returns `whole` with `part` in place of the part that `take` returns. Empty stands for a
    /// missing file or part, also as the result.
    std::function<Configured<Bytes>(std::span<const std::byte> whole,
                                    std::span<const std::byte> part)>
        put{};
};

/// Data of a controller: files of its Storage.
struct MemoryItem {
    /// Shown in verifications and backup files: "Client certificates". Unique.
    std::string name;
    MemoryGroup group{MemoryGroup::ServerSettings};
    std::vector<std::string> files{};
    /// All files directly in these folders; files of subfolders are not included.
    std::vector<std::string> folders{};
    FileAccess access{FileAccess::Owner};
    /// The contents of a new controller, where that is not empty: these files are written where
    /// they are missing when something is restored, and replace what is cleared. Each is one of
    /// `files`.
    struct InitialFile {
        std::string name;
        std::string content;
    };
    std::vector<InitialFile> initial{};
    /// Checks whether a file is valid; a restore with an invalid file is refused. May be empty.
    std::function<Configured<void>(std::string_view name, std::span<const std::byte> bytes)>
        check{};
    /// Set for an item that is part of a file: `files` has one name, by which backups identify the
    /// part, and there are neither folders nor initial files. `check` is called with the shared
    /// file, including all the parts that it will have.
    std::optional<FilePart> part{};
};

/// The limits of backup files, for writing and for reading.
struct MemoryLimits {
    std::size_t max_backup_size{64U << 20U}; // bytes of a backup file
    std::size_t max_file_size{16U << 20U};
    std::size_t max_files{4'096};
    std::size_t max_names_size{256U << 10U}; // bytes of all names together
};

/// Written into a backup file, for people to read.
struct BackupLabel {
    std::string controller;
    DateTime time{};
};

/// The contents of a backup besides server settings and event log.
struct BackupChoice {
    /// False for a file that is given to others (W588, 3-2-9, footnote 1).
    bool security_profile{true};
};

/// The scope of a restore or a verification (W588, 8-2-2).
struct RestoreChoice {
    /// `OpcuaSPF=yes`, `_Card1RestoreCmdTargetOpcuaSPF`. False for transfers of a program from a
    /// card (W588, 3-2-9).
    bool security_profile{true};
};

/// Reads the section [Restore] of RestoreCommand.ini (W588, 8-2-2). OpcuaSPF is
/// "yes" or "no", "yes" if it is missing; UserProgram may not be "no". Other keys belong to other
/// functions. `where` of a problem is "RestoreCommand.ini:4".
[[nodiscard]] BUSBAR_API Configured<RestoreChoice> read_restore_command(std::string_view text);

/// The result of a restore.
enum class Restored : std::uint8_t {
    Data,
    /// The security profile was requested, but the file has none: the controller's is kept.
    WithoutProfile,
    /// The file is from a controller without OPC UA server: server settings, certificate and
    /// security profile are now those of a new controller (W588, 9-2-2,
    /// 95D40000).
    Nothing,
};

/// The result of a verification for one item.
struct VerifiedItem {
    std::string name;
    /// Names of files that differ or exist on one side only; empty if the item is the same.
    std::vector<std::string> differences;
};

/// A controller's data. Every change takes effect completely or not at all, even if the power
/// fails. Records SecurityCleared where 9-2-2 has 95D40000.
///
/// A backup file is a tar: "SHA256SUMS", which `sha256sum -c` takes, "manifest.json" and the files
/// below "files/". lib/controller/backup/FORMAT.md describes it. Files of version 1, which
/// have another form, are read as well.
///
/// Compatibility (W588, 8-2-3): a file with another version of the format, or
/// with items unknown to this controller, is refused. Known items that the file does not have are
/// kept as they are; but a part that the file does not have is looked for in another item's part of
/// the same file, where an earlier version stored it. That version always saved the security
/// profile: in a file without any other data of the profile its parts are not looked for.
///
/// Used by one thread; no other thread reads or writes these files meanwhile.
class BUSBAR_API MachineMemory {
public:
    /// `storage` and `log` must outlive this object. `transaction` is the folder of a
    /// FileTransaction, the same for everything that changes these files in a transaction: only
    /// within one folder are transactions that were decided and wait for the medium kept in order.
    /// Without items it is the memory of a controller without OPC UA server.
    MachineMemory(Storage& storage, std::string transaction, std::vector<MemoryItem> items,
                  LogSink& log, const MemoryLimits& limits = {});

    /// Completes an operation that a power failure interrupted. Call it before these files are
    /// read; the functions below call it too.
    [[nodiscard]] Configured<void> recover() const;

    /// Returns the bytes of the backup file. The server keeps running (manual of variables mode,
    /// 4-1-4). The problem names a file that cannot be read, whose name is not text, or that is too
    /// large.
    [[nodiscard]] Configured<std::vector<std::byte>> backup(const BackupLabel& label,
                                                            const BackupChoice& choice = {}) const;

    /// Replaces the controller's data with the file's. With a problem nothing has changed, and the
    /// text says what is wrong with the file or the storage. Takes effect after a restart, which is
    /// due then (LifeCycle::restore_done).
    [[nodiscard]] Configured<Restored> restore(std::span<const std::byte> backup,
                                               const RestoreChoice& choice);
    /// Compares all items that a restore with this choice would replace, in the file's order.
    [[nodiscard]] Configured<std::vector<VerifiedItem>> verify(std::span<const std::byte> backup,
                                                               const RestoreChoice& choice) const;

    /// Clear All Memory (W588, 8-3), between LifeCycle::clear_begins, which
    /// needs PROGRAM mode, and clear_done. `with_security`: certificate and security profile are
    /// cleared too.
    [[nodiscard]] Configured<void> clear_all(bool with_security, MachineMode mode);
    /// Carries out what the download of a project without OPC UA server requires: certificate,
    /// security profile and server settings become those of a new controller.
    [[nodiscard]] Configured<void> clear_security();

private:
    [[nodiscard]] Configured<detail::SavedMemory> read_for(std::span<const std::byte> backup,
                                                           const RestoreChoice& choice) const;
    [[nodiscard]] Configured<void> put(const detail::SavedMemory& memory,
                                       const RestoreChoice& choice);
    [[nodiscard]] Configured<void> clear(bool with_security);

    Storage* storage_;
    std::string transaction_;
    std::vector<MemoryItem> items_;
    LogSink* log_;
    MemoryLimits limits_;
};

} // namespace busbar::controller
