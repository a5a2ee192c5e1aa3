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

/// The records of what comes into trusted, issuers and rejected and goes from there: what the store
/// does is told by the members named after it, what others do with the files by look().
///
/// Lists have something as often as they have files of it; records tell of it once.
class StoreRecords {
public:
    StoreRecords(StoreLists& lists, LogSink& log) : lists_{&lists}, log_{&log} {}

    void added(StoreList list, const FolderFile& file);
    void removed(StoreList list, const FolderFile& file);
    void moved(StoreList from, StoreList to, const FolderFile& file);

    // What has a record of its own.

    void know(StoreList list, FolderFile file, const CertificateFolder& folder);
    void forget(StoreList list, const std::string& thumbprint) { known(list).erase(thumbprint); }

    /// Tells in what the lists differ from what is known; at first they are taken as they are.
    /// What cannot be read is known still.
    void look(DateTime now);

private:
    struct Known {
        std::string path; // in the storage
        FolderFile file;
    };
    /// By thumbprint.
    using KnownList = std::map<std::string, Known, std::less<>>;

    [[nodiscard]] KnownList& known(StoreList list)
    {
        return known_[static_cast<std::size_t>(list)];
    }
    /// What there is now, and what is known of files that cannot be read now.
    [[nodiscard]] KnownList present(StoreList list);
    void tell_found(std::array<KnownList, 4>& gone, const std::array<KnownList, 4>& come);
    void tell(RecordKind of_certificate, const std::string& what, const FolderFile& file,
              StoreList list, std::string_view from = {}) const;

    StoreLists* lists_;
    LogSink* log_;
    /// By list; empty for those that are not looked at, and before the first look.
    std::array<KnownList, 4> known_;
    bool has_looked_{false};
};

} // namespace busbar::crypto::detail
