#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/storage.hpp>

namespace busbar {

/// Several files of a Storage that change together or not at all, whenever the power goes.
///
///     FileTransaction change{storage, "transaction"};
///     change.recover();                                     // once, at start
///     change.replace("trusted/certs/a.der", der, FileAccess::Everyone);
///     change.remove("rejected/certs/a.der");
///     change.commit();
///
/// What is new lies in a folder of the transaction's until commit() writes its journal there, in
/// one step, which decides. Files then get their names and lose them, for which a medium needs no
/// more space. Who reads meanwhile may see some of it: readers are to be on the same thread.
///
/// One for each folder at a time, one thread. Those that change the same files have one folder:
/// what an earlier one decided and could not do is done before the next one begins.
class BUSBAR_API FileTransaction {
public:
    /// `folder` is the transaction's own and is made when it is needed.
    FileTransaction(Storage& storage, std::string folder);
    FileTransaction(const FileTransaction&) = delete;
    FileTransaction& operator=(const FileTransaction&) = delete;
    /// Forgets what was not committed, as cancel() does.
    ~FileTransaction();

    /// Finishes a transaction that was committed when the power went or the medium failed, and
    /// forgets one that was not. To be called before anything reads those files; replace() and
    /// commit() do it where it was not. Fails as commit() does, or with Failed if the journal makes
    /// no sense, and can be called again.
    [[nodiscard]] Stored<void> recover();

    /// The file will have these bytes. A second call for a name counts instead of the first; its
    /// folder must be there. An error leaves the transaction as it was.
    [[nodiscard]] Stored<void> replace(std::string_view name, std::span<const std::byte> bytes,
                                       FileAccess access);
    /// There will be no such file; whether there is one now does not matter.
    [[nodiscard]] Stored<void> remove(std::string_view name);
    [[nodiscard]] bool empty() const { return steps_.empty(); }

    /// Does all of it. An error before it is decided leaves everything as it was, and the
    /// transaction too. After that is_decided() is true: recover() has to be called until it
    /// succeeds.
    [[nodiscard]] Stored<void> commit();
    [[nodiscard]] bool is_decided() const { return is_decided_; }
    void cancel();

private:
    struct Step {
        std::string name;
        /// Where the new contents lie; empty: the file goes.
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
    bool is_first_{false}; // nothing of an earlier one is in the folder
    bool is_decided_{false};
};

} // namespace busbar
