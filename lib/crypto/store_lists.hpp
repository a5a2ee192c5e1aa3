#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "certificate_folder.hpp"

namespace busbar::crypto::detail {

/// Where a list's file lies.
struct FileInList {
    const CertificateFolder* folder;
    const FolderFile* file;

    /// In the storage.
    [[nodiscard]] std::string name() const { return folder->path_of(file->name); }
};

[[nodiscard]] StoreEntry entry_of(const FileInList& found);

/// For an administrator's operations: earlier than all files, so that each is read anew.
inline constexpr DateTime read_anew{};

/// The lists of a store as the disk has them: what there is, and where new files go.
class StoreLists {
public:
    StoreLists(Storage& storage, const StoreLimits& limits, LogSink& log);

    [[nodiscard]] const StoreLimits& limits() const { return limits_; }
    [[nodiscard]] Storage& storage() const { return *storage_; }

    /// Looks at the disk again. Pointers into the list get invalid.
    void refresh(StoreList list, DateTime now);
    /// Within the limits.
    [[nodiscard]] const TrustList& trust_list(DateTime now);

    // As of the last refresh.

    /// The files that can be used.
    [[nodiscard]] std::vector<FileInList> files(StoreList list) const;
    /// The files with this thumbprint, in any case of its letters.
    [[nodiscard]] std::vector<FileInList> find(StoreList list, std::string_view thumbprint) const;
    [[nodiscard]] std::size_t count(StoreList list, StoreEntry::Kind kind) const;
    [[nodiscard]] std::size_t limit(StoreList list, StoreEntry::Kind kind) const;
    /// A folder of the list has more files than were looked at.
    [[nodiscard]] bool is_cut(StoreList list) const;
    /// The file of that name in the storage may be there, unread: it or its folder cannot be read,
    /// or the folder is cut.
    [[nodiscard]] bool may_hold(StoreList list, std::string_view name) const;
    /// Where new files of the kind go.
    [[nodiscard]] const CertificateFolder& home(StoreList list, StoreEntry::Kind kind) const;

private:
    void collect(StoreList list, std::vector<Certificate>& certificates,
                 std::vector<RevocationList>& revocation_lists) const;
    [[nodiscard]] std::vector<CertificateFolder>& folders(StoreList list);
    [[nodiscard]] const std::vector<CertificateFolder>& folders(StoreList list) const;

    Storage* storage_;
    StoreLimits limits_;
    LogSink* log_;
    std::array<std::vector<CertificateFolder>, 4> folders_;
    TrustList trust_;
    bool is_trust_list_old_{true};
};

} // namespace busbar::crypto::detail
