#include <busbar/crypto/certificate_store.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <busbar/core/status_codes.hpp>
#include <busbar/core/text.hpp>

#include "core/unfinished.hpp"
#include "rejected_list.hpp"
#include "store_lists.hpp"
#include "store_records.hpp"

namespace busbar::crypto {

namespace {

/// Part 12, F.1.
constexpr std::array folders = {"own/certs",     "own/crl",     "trusted/certs",  "trusted/crl",
                                "issuers/certs", "issuers/crl", "rejected/certs", "rejected/crl"};
constexpr const char* private_folder = "own/private";
constexpr std::size_t max_private_files = 10'000;

/// Restricts a file or folder to its owner from now on.
void close_to_others(Storage& storage, const std::string& name, LogSink& log)
{
    const auto closed = storage.close_to_others(name);
    if (closed ? !*closed : closed.error() == StorageError::NotFound) {
        return;
    }
    log.write(LogLevel::Warning, "certificate store",
              printable(storage.place(name)) + " was open to other users than its owner; " +
                  (closed ? "it is closed now" : "it cannot be closed") +
                  ". If a private key there may have been read, replace it");
}

void close_private_keys(Storage& storage, LogSink& log)
{
    close_to_others(storage, private_folder, log);
    const auto found = storage.list(private_folder, max_private_files);
    if (!found) {
        return;
    }
    for (const StorageEntry& entry : found->entries) {
        if (entry.kind == StorageEntry::Kind::File) {
            close_to_others(storage, storage_path(private_folder, entry.name), log);
        }
    }
}

/// Creates the folders, removes what interrupted writers left in them and restricts private keys to
/// their owner. Bad_ConfigurationError if a folder cannot be created.
Result<void> make_folders(Storage& storage, LogSink& log)
{
    for (const char* name : folders) {
        if (!storage.make_folder(name, FileAccess::Everyone)) {
            return fail(status::Bad_ConfigurationError);
        }
    }
    if (!storage.make_folder(private_folder, FileAccess::Owner)) {
        return fail(status::Bad_ConfigurationError);
    }
    busbar::detail::remove_unfinished_below(storage, "");
    close_private_keys(storage, log);
    return {};
}

} // namespace

std::string_view name(StoreList list)
{
    constexpr std::array names = {"own", "trusted", "issuers", "rejected"};
    return names[static_cast<std::size_t>(list)];
}

CertificateStore::CertificateStore(Storage& storage, const StoreLimits& limits, LogSink& log)
    : storage_{&storage}, log_{&log}, lists_{std::make_unique<detail::StoreLists>(storage, limits,
                                                                                  log)},
      records_{std::make_unique<detail::StoreRecords>(*lists_, log)},
      rejected_{std::make_unique<detail::RejectedList>(*lists_, *records_, log)}
{
}

CertificateStore::~CertificateStore() = default;

Result<void> CertificateStore::create()
{
    return make_folders(*storage_, *log_);
}

const TrustList& CertificateStore::trust_list(DateTime now)
{
    return lists_->trust_list(now);
}

void CertificateStore::reject(const Certificate& certificate, DateTime now, std::string_view source)
{
    rejected_->save(certificate, now, source);
}

std::vector<StoreEntry> CertificateStore::list(StoreList list)
{
    lists_->refresh(list, detail::read_anew);
    std::vector<StoreEntry> result;
    for (const detail::FileInList& found : lists_->files(list)) {
        result.push_back(detail::entry_of(found));
    }
    std::sort(result.begin(), result.end(),
              [](const StoreEntry& a, const StoreEntry& b) { return a.file < b.file; });
    return result;
}

Checked<std::string> CertificateStore::show(std::string_view thumbprint)
{
    for (const StoreList list :
         {StoreList::Own, StoreList::Trusted, StoreList::Issuers, StoreList::Rejected}) {
        lists_->refresh(list, detail::read_anew);
        const auto found = lists_->find(list, thumbprint);
        if (found.empty()) {
            continue;
        }
        const Certificate* certificate = found.front().file->certificate();
        return certificate != nullptr
                   ? certificate_text(*certificate)
                   : revocation_list_text(*found.front().file->revocation_list());
    }
    return refuse({status::Bad_NotFound, "Showing a certificate",
                   "no list holds anything with the thumbprint " + printable(thumbprint), "", ""});
}

} // namespace busbar::crypto
