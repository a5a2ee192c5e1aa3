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

/// Backup, restore, verification and Clear All Memory (seed 000, 3-2-9, 8-2 and 8-3).
namespace busbar::controller {

namespace detail {
struct SavedMemory;
} // namespace detail

/// What is done with data (seed 000, 3-2-9). What is in none of these, as the execution log, is
/// neither saved nor cleared.
enum class MemoryGroup : std::uint8_t {
    ServerSettings,    // saved, restored, cleared
    RetainedValues,    // saved, restored, cleared; not verified, as they change all the time
    SecurityProfile,   // saved; restored and cleared by choice
    EventLog,          // saved
    ServerCertificate, // belongs to one controller: cleared by choice
};

/// What an item has of a file that several items share, as settings of two groups that one document
/// holds. In a backup it is a file by itself.
struct FilePart {
    using Bytes = std::vector<std::byte>;

    /// The shared file, of the Storage.
    std::string file;
    /// What of `whole` is the item's; empty if nothing is. The same whatever else is in `whole`,
    /// and of what it gave the same again. Without a file `whole` is empty.
    std::function<Configured<Bytes>(std::span<const std::byte> whole)> take{};
    /// `whole` with `part` in the place of what `take` has of it. Empty is what is not there, also
    /// as the result.
    std::function<Configured<Bytes>(std::span<const std::byte> whole,
                                    std::span<const std::byte> part)>
        put{};
};

/// Data of a controller: some files of its Storage.
struct MemoryItem {
    /// For people, in verifications and in backup files: "Client certificates". Each once.
    std::string name;
    MemoryGroup group{MemoryGroup::ServerSettings};
    std::vector<std::string> files{};
    /// All files in them, not those in folders in them.
    std::vector<std::string> folders{};
    FileAccess access{FileAccess::Owner};
    /// What a new controller has instead of nothing: these files are put where they are missing
    /// when something is restored, and come in the place of what is cleared. Each is one of
    /// `files`.
    struct InitialFile {
        std::string name;
        std::string content;
    };
    std::vector<InitialFile> initial{};
    /// Whether a file makes sense; a restore that brings one that does not is refused. May be
    /// empty.
    std::function<Configured<void>(std::string_view name, std::span<const std::byte> bytes)>
        check{};
    /// An item that is part of a file: `files` has one name, by which backups know the part, and
    /// there are neither folders nor initial files. `check` is asked about the shared file, with
    /// all the parts that it will have.
    std::optional<FilePart> part{};
};

struct MemoryLimits {
    std::size_t max_backup_size{64U << 20U}; // bytes of a backup file
    std::size_t max_file_size{16U << 20U};
    std::size_t max_files{4'096};
    std::size_t max_names_size{256U << 10U}; // bytes of all names together
};

/// Written into a backup file, for people.
struct BackupLabel {
    std::string controller;
    DateTime time{};
};

/// What a backup is to have besides server settings and event log.
struct BackupChoice {
    /// False for a file that is given away (seed 000, 3-2-9, footnote 1).
    bool security_profile{true};
};

/// What a restore or a verification is about (seed 000, 8-2-2).
struct RestoreChoice {
    /// `OpcuaSPF=yes`, `_Card1RestoreCmdTargetOpcuaSPF`. False for transfers of a program from a
    /// card (seed 000, 3-2-9).
    bool security_profile{true};
};

/// RestoreCommand.ini: the section [Restore] (seed 000, 8-2-2). OpcuaSPF is "yes" or "no", "yes" if
/// it is not there; UserProgram may not be "no". Other keys are other functions' business. `where`
/// of a problem is "RestoreCommand.ini:4".
[[nodiscard]] BUSBAR_API Configured<RestoreChoice> read_restore_command(std::string_view text);

enum class Restored : std::uint8_t {
    Data,
    /// The security profile was asked for, and the file has none: the controller's stays.
    WithoutProfile,
    /// The file is of a controller without OPC UA server: server settings, certificate and security
    /// profile are those of a new controller now (seed 000, 9-2-2, 95D40000).
    Nothing,
};

/// One item in a verification.
struct VerifiedItem {
    std::string name;
    /// Names of files that differ or are on one side only; none: the item is the same.
    std::vector<std::string> differences;
};

/// A controller's data. All that changes it changes it whole or not at all, whenever the power
/// goes. Records SecurityCleared where 9-2-2 has 95D40000.
///
/// A backup file: "BUSBARBK", version and size of the manifest (32 bits each, little-endian), the
/// manifest, the bytes of all files in its order, and the CRC-32 of all that comes before it. The
/// manifest is JSON: "controller", "created", "opc_ua" (false: of a controller without OPC UA
/// server; no items) and "items", each with "name", "group" ("settings", "values", "security",
/// "events") and "files" with "name" and "size".
///
/// Compatibility (seed 000, 8-2-3): a file of another version of the format is refused, and so is
/// one with items that this controller does not know. Items that it knows and the file does not
/// stay as they are; but a part that the file has not is looked for in another item's part of the
/// same file, where an earlier version had it. That version saved the security profile always: in a
/// file without any other data of the profile its parts are not looked for.
///
/// One thread, on which nobody else reads or writes these files meanwhile.
class BUSBAR_API MachineMemory {
public:
    /// `storage` and `log` must outlive this object. `transaction` is the folder of a
    /// FileTransaction, the same for all that changes these files by one: an order among those that
    /// were decided and wait for the medium is only in one folder. Without items it is the memory
    /// of a controller without OPC UA server.
    MachineMemory(Storage& storage, std::string transaction, std::vector<MemoryItem> items,
                  LogSink& log, const MemoryLimits& limits = {});

    /// Finishes what the power cut. Before anything reads those files; what is below does it, too.
    [[nodiscard]] Configured<void> recover() const;

    /// The backup file's bytes. The server goes on meanwhile (seed 000, 4-1-4). The problem names a
    /// file that cannot be read, has a name that is no text, or is too large.
    [[nodiscard]] Configured<std::vector<std::byte>> backup(const BackupLabel& label,
                                                            const BackupChoice& choice = {}) const;

    /// Puts the file's data in the place of the controller's. A problem: nothing has changed, and
    /// the text says what is wrong with the file or the storage. Counts after a restart, which is
    /// due then (LifeCycle::restore_done).
    [[nodiscard]] Configured<Restored> restore(std::span<const std::byte> backup,
                                               const RestoreChoice& choice);
    /// All items that a restore with this choice would bring, in the file's order.
    [[nodiscard]] Configured<std::vector<VerifiedItem>> verify(std::span<const std::byte> backup,
                                                               const RestoreChoice& choice) const;

    /// Clear All Memory (seed 000, 8-3), between LifeCycle::clear_begins, which wants PROGRAM mode,
    /// and clear_done. `with_security`: certificate and security profile, too.
    [[nodiscard]] Configured<void> clear_all(bool with_security, MachineMode mode);
    /// What the download of a project without OPC UA server does: certificate and security profile
    /// are those of a new controller, and so are the server settings.
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
