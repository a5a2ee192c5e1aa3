#include <busbar/crypto/certificate_store.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>

#include "store_lists.hpp"
#include "store_names.hpp"
#include "store_records.hpp"

namespace busbar::crypto {

namespace {

using detail::CertificateFolder;
using detail::FileInList;
using detail::FolderFile;
using EntryKind = StoreEntry::Kind;

// The names of the operations in refusals.
constexpr std::string_view adding = "Adding to the certificate store";
constexpr std::string_view removing = "Removing from the certificate store";
constexpr std::string_view moving = "Moving in the certificate store";

std::string name_of(StoreList list)
{
    return std::string{name(list)};
}

/// Returns the extension that a moved file keeps, since some tools rely on it.
std::string ending_of(const FileInList& found)
{
    constexpr std::array endings = {".der", ".pem", ".crt", ".cer", ".crl"};
    const std::string& file = found.file->name;
    const std::string ending = file.substr(std::min(file.rfind('.'), file.size()));
    const bool is_known = std::find(endings.begin(), endings.end(), ending) != endings.end();
    return is_known ? ending : found.folder->kind() == EntryKind::Certificate ? ".der" : ".crl";
}

std::string base_name_of(const FolderFile& file)
{
    const Certificate* certificate = file.certificate();
    return certificate != nullptr ? detail::store_file_name(*certificate)
                                  : detail::store_file_name(*file.revocation_list());
}

/// Parses one certificate or revocation list, with its future file name.
std::optional<FolderFile> parse(std::span<const std::byte> contents)
{
    FolderFile file;
    if (auto certificate = Certificate::parse_file(contents)) {
        file.object = *std::move(certificate);
        file.name = base_name_of(file) + ".der";
    } else if (auto list = RevocationList::parse_file(contents)) {
        file.object = *std::move(list);
        file.name = base_name_of(file) + ".crl";
    } else {
        return std::nullopt;
    }
    return file;
}

std::span<const std::byte> der_of(const FolderFile& file)
{
    return file.certificate() != nullptr ? file.certificate()->der()
                                         : file.revocation_list()->der();
}

Unexpected<Refusal> refuse_own(std::string_view check)
{
    return refuse({status::Bad_NotSupported, check,
                   "a certificate of the own list comes with its private key, not alone", "",
                   "Install both together"});
}

Unexpected<Refusal> refuse_missing(std::string_view check, StoreList list,
                                   std::string_view thumbprint)
{
    return refuse({status::Bad_NotFound, check,
                   name_of(list) + " holds nothing with the thumbprint " + printable(thumbprint),
                   "", ""});
}

Unexpected<Refusal> refuse_disk(StorageError error, std::string_view check, StoreList list)
{
    return refuse(
        {status_of(error), check,
         "the disk did not accept the change of " + name_of(list) + ": " + std::string{text(error)},
         "", "Check free space and permissions of the store's folder"});
}

std::optional<Refusal> check_room(const detail::StoreLists& lists, std::string_view check,
                                  StoreList list, EntryKind kind)
{
    const std::size_t limit = lists.limit(list, kind);
    if (lists.count(list, kind) < limit && !lists.is_cut(list)) {
        return std::nullopt;
    }
    return Refusal{status::Bad_ResourceUnavailable, check,
                   name_of(list) + " is full: its limit is " + std::to_string(limit) +
                       (kind == EntryKind::Certificate ? " certificates" : " revocation lists"),
                   "", "Remove one that is no longer needed"};
}

/// Returns false if another certificate has the name; a file that cannot be used is replaced.
bool can_write(const CertificateFolder& folder, const std::string& name)
{
    const auto& files = folder.files();
    return std::none_of(files.begin(), files.end(), [&](const detail::FolderFile& file) {
        return file.name == name && file.is_usable();
    });
}

Checked<void> check_addition(const detail::StoreLists& lists, StoreList list, EntryKind kind,
                             const FolderFile& file)
{
    if (!lists.find(list, file.thumbprint()).empty() ||
        !can_write(lists.home(list, kind), file.name)) {
        return refuse({status::Bad_EntryExists, adding,
                       name_of(list) + " holds " + file.thumbprint() + " already", "", ""});
    }
    auto full = check_room(lists, adding, list, kind);
    return full ? Checked<void>{refuse(*std::move(full))} : Checked<void>{};
}

Checked<void> move_one(const detail::StoreLists& lists, const FileInList& found, StoreList to)
{
    const EntryKind kind = found.folder->kind();
    if (auto full = check_room(lists, moving, to, kind)) {
        return refuse(*std::move(full));
    }
    const CertificateFolder& home = lists.home(to, kind);
    const std::string name = base_name_of(*found.file) + ending_of(found);
    if (!can_write(home, name)) {
        return refuse({status::Bad_EntryExists, moving,
                       home.name() + " holds another file called " + printable(name), "",
                       "Remove that one or give it another name"});
    }
    // The present file cannot be used.
    const auto moved = lists.storage().move(found.name(), home.path_of(name), WhenThere::Replace);
    return moved ? Checked<void>{} : Checked<void>{refuse_disk(moved.error(), moving, to)};
}

Checked<void> remove_all(const detail::StoreLists& lists, const std::vector<FileInList>& files,
                         std::string_view check, StoreList list)
{
    for (const FileInList& one : files) {
        if (const auto removed = lists.storage().remove(one.name()); !removed) {
            return refuse_disk(removed.error(), check, list);
        }
    }
    return {};
}

} // namespace

void CertificateStore::tell_changes(const TrustList& before, const TrustList& after)
{
    const auto tell = [&](const TrustList& some, const TrustList& others, bool is_added) {
        const auto tell_missing = [&](StoreList list, const auto& mine, const auto& theirs) {
            for (const auto& each : mine) {
                const bool is_there = std::ranges::any_of(theirs, [&](const auto& other) {
                    return std::ranges::equal(other.der(), each.der());
                });
                const auto file = is_there ? std::nullopt : parse(each.der());
                if (file && is_added) {
                    records_->added(list, *file);
                } else if (file) {
                    records_->removed(list, *file);
                }
            }
        };
        tell_missing(StoreList::Trusted, some.trusted, others.trusted);
        tell_missing(StoreList::Trusted, some.trusted_crls, others.trusted_crls);
        tell_missing(StoreList::Issuers, some.issuers, others.issuers);
        tell_missing(StoreList::Issuers, some.issuer_crls, others.issuer_crls);
    };
    tell(before, after, false);
    tell(after, before, true);
}

void CertificateStore::tell_found_changes(DateTime now)
{
    records_->look(now);
}

Checked<StoreEntry> CertificateStore::add(StoreList list, std::span<const std::byte> contents)
{
    if (list == StoreList::Own) {
        return refuse_own(adding);
    }
    if (detail::holds_several_certificates(contents)) {
        return refuse({status::Bad_CertificateInvalid, adding, "more than one certificate", "",
                       "Add each of them alone"});
    }
    const auto file = contents.size() > lists_->limits().max_revocation_list_file_size
                          ? std::nullopt
                          : parse(contents);
    if (!file) {
        return refuse({status::Bad_CertificateInvalid, adding,
                       "neither a certificate nor a revocation list in DER or PEM", "", ""});
    }
    lists_->refresh(list, detail::read_anew);
    const EntryKind kind =
        file->certificate() != nullptr ? EntryKind::Certificate : EntryKind::RevocationList;
    if (auto checked = check_addition(*lists_, list, kind, *file); !checked) {
        return refuse(std::move(checked.error()));
    }
    const CertificateFolder& home = lists_->home(list, kind);
    StoreEntry entry = detail::entry_of({&home, &*file});
    const auto saved =
        storage_->replace(home.path_of(file->name), der_of(*file), FileAccess::Everyone);
    if (!saved) {
        return refuse_disk(saved.error(), adding, list);
    }
    // The change is done, even if it cannot be reported.
    busbar::detail::attempt([&] { records_->added(list, *file); });
    return entry;
}

Checked<void> CertificateStore::remove(StoreList list, std::string_view thumbprint)
{
    if (list == StoreList::Own) {
        return refuse_own(removing);
    }
    lists_->refresh(list, detail::read_anew);
    const auto found = lists_->find(list, thumbprint);
    if (found.empty()) {
        return refuse_missing(removing, list, thumbprint);
    }
    const FolderFile file = *found.front().file;
    if (auto removed = remove_all(*lists_, found, removing, list); !removed) {
        return removed;
    }
    // The change is done, even if it cannot be reported.
    busbar::detail::attempt([&] { records_->removed(list, file); });
    return {};
}

Checked<void> CertificateStore::move(std::string_view thumbprint, StoreList from, StoreList to)
{
    if (from == StoreList::Own || to == StoreList::Own) {
        return refuse_own(moving);
    }
    lists_->refresh(from, detail::read_anew);
    lists_->refresh(to, detail::read_anew);
    auto found = lists_->find(from, thumbprint);
    if (found.empty()) {
        return refuse_missing(moving, from, thumbprint);
    }
    if (from == to) {
        return {};
    }
    const FolderFile file = *found.front().file;
    if (lists_->find(to, thumbprint).empty()) {
        if (auto moved = move_one(*lists_, found.front(), to); !moved) {
            return moved;
        }
        found.erase(found.begin());
    }
    if (auto removed = remove_all(*lists_, found, moving, from); !removed) {
        return removed;
    }
    // The change is done, even if it cannot be reported.
    busbar::detail::attempt([&] { records_->moved(from, to, file); });
    return {};
}

} // namespace busbar::crypto
