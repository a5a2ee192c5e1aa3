#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "certificate_folder.hpp"

namespace busbar::crypto::detail {

/// A file of a list and its folder.
struct FileInList {
    const CertificateFolder* folder;
    const FolderFile* file;

    /// Its name in the storage.
    [[nodiscard]] std::string name() const { return folder->path_of(file->name); }
};

[[nodiscard]] StoreEntry entry_of(const FileInList& found);

/// For an administrator's operations: earlier than all files, so that each is read again.
inline constexpr DateTime read_anew{};

/// The lists of a store as on the disk: their files, and the places for new ones.
class StoreLists {
public:
    StoreLists(Storage& storage, const StoreLimits& limits, LogSink& log);

    [[nodiscard]] const StoreLimits& limits() const { return limits_; }
    [[nodiscard]] Storage& storage() const { return *storage_; }

    /// Reads the disk again. Pointers into the list become invalid.
    void refresh(StoreList list, DateTime now);
    /// Returns the trust list within the limits.
    [[nodiscard]] const TrustList& trust_list(DateTime now);

    // State of the last refresh.

    /// The usable files.
    [[nodiscard]] std::vector<FileInList> files(StoreList list) const;
    /// The files with this thumbprint, in any case of its letters.
    [[nodiscard]] std::vector<FileInList> find(StoreList list, std::string_view thumbprint) const;
    [[nodiscard]] std::size_t count(StoreList list, StoreEntry::Kind kind) const;
    [[nodiscard]] std::size_t limit(StoreList list, StoreEntry::Kind kind) const;
    /// True if a folder of the list has more files than were read.
    [[nodiscard]] bool is_cut(StoreList list) const;
    /// True if the file of this name may exist unread: it or its folder cannot be read, or the
    /// folder is cut.
    [[nodiscard]] bool may_hold(StoreList list, std::string_view name) const;
    /// The folder for new files of this kind.
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
