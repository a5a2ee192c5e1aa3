#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/record.hpp>

#include "store_lists.hpp"

namespace busbar::crypto::detail {

/// Records what comes into trusted, issuers and rejected and leaves them: the store's own changes
/// by the members named after them, changes of the files by others in look().
///
/// A list may have several files with the same content; it is recorded once.
class StoreRecords {
public:
    StoreRecords(StoreLists& lists, LogSink& log) : lists_{&lists}, log_{&log} {}

    void added(StoreList list, const FolderFile& file);
    void removed(StoreList list, const FolderFile& file);
    void moved(StoreList from, StoreList to, const FolderFile& file);

    // Changes that have a record of their own.

    void know(StoreList list, FolderFile file, const CertificateFolder& folder);
    void forget(StoreList list, const std::string& thumbprint) { known(list).erase(thumbprint); }

    /// Records the differences of the lists from the known state, which begins as the first look
    /// finds it. Entries that cannot be read stay known.
    void look(DateTime now);

private:
    struct Known {
        std::string path; // in the storage
        FolderFile file;
    };
    /// Records by thumbprint.
    using KnownList = std::map<std::string, Known, std::less<>>;

    using KnownLists = std::array<KnownList, 4>;
    /// What one reading of the lists finds, and its differences from the known state.
    struct Found {
        KnownLists present;
        KnownLists gone;
        KnownLists come;
    };

    [[nodiscard]] KnownList& known(StoreList list)
    {
        return known_[static_cast<std::size_t>(list)];
    }
    /// Returns the present entries, and known ones of files that cannot be read now.
    [[nodiscard]] KnownList present(StoreList list);
    [[nodiscard]] Found differences(DateTime now);
    void tell_found(KnownLists& gone, const KnownLists& come);
    void tell(RecordKind of_certificate, const std::string& what, const FolderFile& file,
              StoreList list, std::string_view from = {}) const;

    StoreLists* lists_;
    LogSink* log_;
    /// Known entries by list; empty for lists that are not watched, and before the first look.
    KnownLists known_;
    bool has_looked_{false};
};

} // namespace busbar::crypto::detail
