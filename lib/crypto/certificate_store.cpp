#include <busbar/crypto/certificate_store.hpp>

#include <algorithm>
#include <array>
#include <utility>

#include <busbar/core/text.hpp>

#include "rejected_list.hpp"
#include "store_folders.hpp"
#include "store_lists.hpp"
#include "store_records.hpp"

namespace busbar::crypto {

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
    return detail::make_store_folders(*storage_, *log_);
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
