#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/storage.hpp>

namespace busbar {

/// Changes several files of a Storage together or not at all, whenever the power fails.
///
///     FileTransaction change{storage, "transaction"};
///     change.recover();                                     // once, at start
///     change.replace("trusted/certs/a.der", der, FileAccess::Everyone);
///     change.remove("rejected/certs/a.der");
///     change.commit();
///
/// New contents lie in a folder of the transaction until commit() writes its journal there, in one
/// step, which decides. Files then get and lose their names, for which a medium needs no more
/// space. A reader on another thread may see some of the changes meanwhile; readers should use the
/// same thread.
///
/// There is one transaction for each folder at a time, on one thread. Transactions that change the
/// same files share one folder: what an earlier one decided and could not finish is finished before
/// the next one begins.
class BUSBAR_API FileTransaction {
public:
    /// `folder` belongs to the transaction alone and is created when it is needed.
    FileTransaction(Storage& storage, std::string folder);
    FileTransaction(const FileTransaction&) = delete;
    FileTransaction& operator=(const FileTransaction&) = delete;
    /// Forgets what was not committed, as cancel() does.
    ~FileTransaction();

    /// Finishes a transaction that was committed when the power or the medium failed, and discards
    /// one that was not. Call it before anything reads those files; replace() and commit() do it if
    /// that was missed. Fails as commit() does, or with Failed if the journal is invalid, and can
    /// be called again.
    [[nodiscard]] Stored<void> recover();

    /// Gives the file these bytes on commit. A second call for a name replaces the first; the
    /// file's folder must exist. An error leaves the transaction as it was.
    [[nodiscard]] Stored<void> replace(std::string_view name, std::span<const std::byte> bytes,
                                       FileAccess access);
    /// Removes the file on commit; it need not exist.
    [[nodiscard]] Stored<void> remove(std::string_view name);
    [[nodiscard]] bool empty() const { return steps_.empty(); }

    /// Makes all changes. If it fails before they are decided, files and transaction stay as they
    /// were. After that is_decided() is true, and recover() must be called until it succeeds.
    [[nodiscard]] Stored<void> commit();
    [[nodiscard]] bool is_decided() const { return is_decided_; }
    void cancel();

private:
    struct Step {
        std::string name;
        /// The place of the new contents; if empty, the file is removed.
        std::string staged;
    };

    [[nodiscard]] std::string journal() const { return storage_path(folder_, "journal.json"); }
    [[nodiscard]] Stored<void> finish_earlier();
    void set(std::string_view name, std::string staged);
    [[nodiscard]] Stored<std::vector<Step>> read_journal() const;
    [[nodiscard]] Stored<void> carry_out(const std::vector<Step>& steps);
    void forget_staged();

    Storage* storage_;
    std::string folder_;
    std::vector<Step> steps_;
    std::size_t next_number_{0};
    bool is_first_{false}; // no file of an earlier transaction is in the folder
    bool is_decided_{false};
};

} // namespace busbar
