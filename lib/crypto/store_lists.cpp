#include "store_lists.hpp"

#include <algorithm>

#include <busbar/core/text.hpp>

#include "openssl.hpp"

namespace busbar::crypto::detail {

namespace {

using EntryKind = StoreEntry::Kind;

struct Place {
    StoreList list;
    const char* folder;
    FolderContents contents;
    bool is_home;
};

/// Part 12, F.1, and the additional places that are read (see CertificateStore). A list's home for
/// each kind comes first.
constexpr std::array places = {
    Place{StoreList::Own, "own/certs", FolderContents::Chains, true},
    Place{StoreList::Own, "own/crl", FolderContents::RevocationLists, true},
    Place{StoreList::Trusted, "trusted/certs", FolderContents::Certificates, true},
    Place{StoreList::Trusted, "trusted/crl", FolderContents::RevocationLists, true},
    Place{StoreList::Trusted, "trusted", FolderContents::Certificates, false},
    Place{StoreList::Issuers, "issuers/certs", FolderContents::Certificates, true},
    Place{StoreList::Issuers, "issuers/crl", FolderContents::RevocationLists, true},
    Place{StoreList::Issuers, "issuers", FolderContents::Certificates, false},
    Place{StoreList::Issuers, "issuer/certs", FolderContents::Certificates, false},
    Place{StoreList::Issuers, "issuer/crl", FolderContents::RevocationLists, false},
    Place{StoreList::Rejected, "rejected/certs", FolderContents::Certificates, true},
    Place{StoreList::Rejected, "rejected/crl", FolderContents::RevocationLists, true},
    Place{StoreList::Rejected, "rejected", FolderContents::Certificates, false},
};

bool is_same_thumbprint(std::string_view a, std::string_view b)
{
    const auto upper = [](char c) { return c >= 'a' && c <= 'f' ? static_cast<char>(c - 32) : c; };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [&](char x, char y) { return upper(x) == upper(y); });
}

} // namespace

StoreEntry entry_of(const FileInList& found)
{
    StoreEntry entry;
    entry.kind = found.folder->kind();
    entry.file = printable(found.name(), 512);
    entry.thumbprint = found.file->thumbprint();
    if (const Certificate* certificate = found.file->certificate()) {
        entry.subject = printable(certificate->subject());
        entry.issuer = printable(text_of(X509_get_issuer_name(certificate->native())));
        entry.valid_from = certificate->valid_from();
        entry.valid_to = certificate->valid_to();
    } else if (const RevocationList* list = found.file->revocation_list()) {
        entry.subject = printable(list->issuer());
        entry.issuer = entry.subject;
        entry.valid_from = list->this_update();
        entry.valid_to = list->next_update();
    }
    return entry;
}

StoreLists::StoreLists(Storage& storage, const StoreLimits& limits, LogSink& log)
    : storage_{&storage}, limits_{limits}, log_{&log}
{
    for (const Place& place : places) {
        folders(place.list).emplace_back(storage, place.folder, place.contents, !place.is_home);
    }
}

std::vector<CertificateFolder>& StoreLists::folders(StoreList list)
{
    return folders_[static_cast<std::size_t>(list)];
}

const std::vector<CertificateFolder>& StoreLists::folders(StoreList list) const
{
    return folders_[static_cast<std::size_t>(list)];
}

void StoreLists::refresh(StoreList list, DateTime now)
{
    for (CertificateFolder& folder : folders(list)) {
        // Set at once, since the next folder may run out of memory.
        is_trust_list_old_ = folder.refresh(limits_, now, *log_) || is_trust_list_old_;
    }
}

std::vector<FileInList> StoreLists::files(StoreList list) const
{
    std::vector<FileInList> result;
    for (const CertificateFolder& folder : folders(list)) {
        for (const FolderFile& file : folder.files()) {
            if (file.is_usable()) {
                result.push_back({&folder, &file});
            }
        }
    }
    return result;
}

std::vector<FileInList> StoreLists::find(StoreList list, std::string_view thumbprint) const
{
    std::vector<FileInList> result = files(list);
    result.erase(std::remove_if(result.begin(), result.end(),
                                [&](const FileInList& found) {
                                    return !is_same_thumbprint(found.file->thumbprint(),
                                                               thumbprint);
                                }),
                 result.end());
    return result;
}

std::size_t StoreLists::count(StoreList list, EntryKind kind) const
{
    const std::vector<FileInList> all = files(list);
    return static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(),
                      [&](const FileInList& found) { return found.folder->kind() == kind; }));
}

std::size_t StoreLists::limit(StoreList list, EntryKind kind) const
{
    if (kind == EntryKind::RevocationList) {
        return limits_.max_revocation_lists;
    }
    return list == StoreList::Rejected ? limits_.max_rejected : limits_.max_certificates;
}

bool StoreLists::is_cut(StoreList list) const
{
    const auto& all = folders(list);
    return std::any_of(all.begin(), all.end(),
                       [](const CertificateFolder& folder) { return folder.is_cut(); });
}

bool StoreLists::may_hold(StoreList list, std::string_view name) const
{
    const auto& all = folders(list);
    return std::any_of(all.begin(), all.end(), [&](const CertificateFolder& folder) {
        const std::size_t slash = name.rfind('/');
        return name.substr(0, slash) == folder.name() && folder.may_hold(name.substr(slash + 1));
    });
}

const CertificateFolder& StoreLists::home(StoreList list, EntryKind kind) const
{
    const auto& all = folders(list);
    return *std::find_if(all.begin(), all.end(),
                         [&](const CertificateFolder& folder) { return folder.kind() == kind; });
}

void StoreLists::collect(StoreList list, std::vector<Certificate>& certificates,
                         std::vector<RevocationList>& revocation_lists) const
{
    bool is_over = false;
    for (const FileInList& found : files(list)) {
        const EntryKind kind = found.folder->kind();
        const std::size_t size =
            kind == EntryKind::Certificate ? certificates.size() : revocation_lists.size();
        if (size >= limit(list, kind)) {
            is_over = true;
        } else if (kind == EntryKind::Certificate) {
            certificates.push_back(*found.file->certificate());
        } else {
            revocation_lists.push_back(*found.file->revocation_list());
        }
    }
    if (is_over) {
        log_->write(LogLevel::Warning, "certificate store",
                    std::string{name(list)} +
                        " holds more files than its limit; the last by name do not count");
    }
}

const TrustList& StoreLists::trust_list(DateTime now)
{
    refresh(StoreList::Trusted, now);
    refresh(StoreList::Issuers, now);
    if (is_trust_list_old_) {
        trust_ = {};
        collect(StoreList::Trusted, trust_.trusted, trust_.trusted_crls);
        collect(StoreList::Issuers, trust_.issuers, trust_.issuer_crls);
        is_trust_list_old_ = false;
    }
    return trust_;
}

} // namespace busbar::crypto::detail
