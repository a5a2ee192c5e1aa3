#include <busbar/crypto/certificate_store.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include "store_lists.hpp"
#include "store_names.hpp"

/// Replaces whole lists of a store, as part of a transaction.
namespace busbar::crypto {

namespace {

using detail::CertificateFolder;
using detail::FileInList;
using EntryKind = StoreEntry::Kind;

constexpr std::string_view check = "Changing the certificate store";

/// A file that a list's folder shall have.
struct WantedFile {
    std::string thumbprint;
    std::string name;
    std::span<const std::byte> der;
};

template <typename T>
std::vector<WantedFile> files_of(const std::vector<T>& objects, const char* ending)
{
    std::vector<WantedFile> files;
    for (const T& object : objects) {
        WantedFile file{object.thumbprint_text(), detail::store_file_name(object) + ending,
                        object.der()};
        const bool is_there = std::any_of(files.begin(), files.end(), [&](const WantedFile& other) {
            return other.thumbprint == file.thumbprint;
        });
        if (!is_there) {
            files.push_back(std::move(file));
        }
    }
    return files;
}

/// One list of one kind: its present and its future content.
class StagedList {
public:
    StagedList(const detail::StoreLists& lists, StoreList list, EntryKind kind,
               FileTransaction& change, std::string_view folder)
        : lists_{lists}, list_{list}, home_{lists.home(list, kind)}, change_{change}, folder_{
                                                                                          folder}
    {
        for (const FileInList& file : lists.files(list)) {
            if (file.folder->kind() == kind) {
                present_.push_back(file);
            }
        }
    }

    [[nodiscard]] Checked<void> stage(const std::vector<WantedFile>& wanted, std::size_t limit)
    {
        if (wanted.size() > limit || lists_.is_cut(list_)) {
            return refuse({status::Bad_ResourceUnavailable, check,
                           std::string{name(list_)} + " would have " +
                               std::to_string(wanted.size()) + " entries, its limit is " +
                               std::to_string(limit),
                           "", "Send fewer"});
        }
        for (const FileInList& file : present_) {
            if (!is_wanted(file, wanted)) {
                if (auto removed = change_.remove(path_of(file.name())); !removed) {
                    return refuse_storage(removed.error());
                }
            }
        }
        for (const WantedFile& file : wanted) {
            if (is_present(file)) {
                continue;
            }
            if (is_taken(file, wanted)) {
                return refuse({status::Bad_EntryExists, check,
                               home_.name() + " holds another file called " + file.name, "",
                               "Give that one another name"});
            }
            auto added =
                change_.replace(path_of(home_.path_of(file.name)), file.der, FileAccess::Everyone);
            if (!added) {
                return refuse_storage(added.error());
            }
        }
        return {};
    }

private:
    [[nodiscard]] std::string path_of(const std::string& name) const
    {
        return storage_path(folder_, name);
    }
    static bool is_wanted(const FileInList& file, const std::vector<WantedFile>& wanted)
    {
        return std::any_of(wanted.begin(), wanted.end(), [&](const WantedFile& each) {
            return each.thumbprint == file.file->thumbprint();
        });
    }
    [[nodiscard]] bool is_present(const WantedFile& wanted) const
    {
        return std::any_of(present_.begin(), present_.end(), [&](const FileInList& file) {
            return file.file->thumbprint() == wanted.thumbprint;
        });
    }
    /// Returns whether another certificate that stays has the name.
    [[nodiscard]] bool is_taken(const WantedFile& file, const std::vector<WantedFile>& wanted) const
    {
        return std::any_of(present_.begin(), present_.end(), [&](const FileInList& other) {
            return other.folder == &home_ && other.file->name == file.name &&
                   is_wanted(other, wanted);
        });
    }
    [[nodiscard]] Unexpected<Refusal> refuse_storage(StorageError error) const
    {
        return refuse({status_of(error), check,
                       "the storage did not accept the change of " + std::string{name(list_)} +
                           ": " + std::string{text(error)},
                       "", "Check free space and permissions of the store's folder"});
    }

    const detail::StoreLists& lists_;
    StoreList list_;
    const CertificateFolder& home_;
    FileTransaction& change_;
    std::string_view folder_;
    std::vector<FileInList> present_;
};

} // namespace

Checked<void> CertificateStore::stage(const TrustList& wanted, const TrustListParts& parts,
                                      FileTransaction& change, std::string_view folder)
{
    lists_->refresh(StoreList::Trusted, detail::read_anew);
    lists_->refresh(StoreList::Issuers, detail::read_anew);
    const auto stage_one = [&](bool is_meant, StoreList list, EntryKind kind,
                               const std::vector<WantedFile>& files) -> Checked<void> {
        return is_meant ? StagedList{*lists_, list, kind, change, folder}.stage(
                              files, lists_->limit(list, kind))
                        : Checked<void>{};
    };
    auto done = stage_one(parts.trusted, StoreList::Trusted, EntryKind::Certificate,
                          files_of(wanted.trusted, ".der"));
    if (done) {
        done = stage_one(parts.trusted_crls, StoreList::Trusted, EntryKind::RevocationList,
                         files_of(wanted.trusted_crls, ".crl"));
    }
    if (done) {
        done = stage_one(parts.issuers, StoreList::Issuers, EntryKind::Certificate,
                         files_of(wanted.issuers, ".der"));
    }
    if (done) {
        done = stage_one(parts.issuer_crls, StoreList::Issuers, EntryKind::RevocationList,
                         files_of(wanted.issuer_crls, ".crl"));
    }
    return done;
}

} // namespace busbar::crypto
