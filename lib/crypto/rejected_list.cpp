#include "rejected_list.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include <busbar/core/text.hpp>

#include "store_names.hpp"

namespace busbar::crypto::detail {

namespace {

using EntryKind = StoreEntry::Kind;

constexpr std::int64_t one_minute = 60 * DateTime::ticks_per_second;

bool is_older(const FileInList& a, const FileInList& b)
{
    return std::tie(a.file->modified, a.file->name) < std::tie(b.file->modified, b.file->name);
}

} // namespace

bool RejectedList::may_act(DateTime now, std::string_view source)
{
    constexpr std::size_t sources = 4; // share the limit
    if (now < minute_ || now.ticks - minute_.ticks >= one_minute) {
        minute_ = now;
        acted_ = 0;
        acted_for_.clear();
        is_told_ = false;
    }
    const std::size_t limit = lists_->limits().max_rejected_per_minute;
    const auto own = acted_for_.find(source);
    const bool has_share =
        own == acted_for_.end() || own->second < limit / sources + (limit % sources != 0 ? 1 : 0);
    if (acted_ < limit && has_share) {
        ++acted_;
        if (!source.empty()) {
            ++acted_for_[std::string{source}];
        }
        return true;
    }
    if (!std::exchange(is_told_, true)) {
        log_->write(LogLevel::Warning, "certificate store",
                    has_share
                        ? "more strangers than the limit within a minute: the certificates of "
                          "further ones are not saved"
                        : "more strangers from " + printable(source) +
                              " than a quarter of the limit within a minute: the certificates of "
                              "further ones from there are not saved");
    }
    return false;
}

bool RejectedList::contains(const Certificate& certificate) const
{
    const auto files = lists_->files(StoreList::Rejected);
    return std::any_of(files.begin(), files.end(), [&](const FileInList& found) {
        const Certificate* one = found.file->certificate();
        return one != nullptr && *one == certificate;
    });
}

void RejectedList::tell(RecordKind kind, const Certificate& certificate,
                        std::string_view what) const
{
    const bool is_saved = kind == RecordKind::CertificateSaved;
    Record record{kind, is_saved ? LogLevel::Info : LogLevel::Warning, "certificate store"};
    record.text = printable(certificate.subject()) + ", " + certificate.thumbprint_text() + ", " +
                  std::string{what};
    record.certificate = certificate.der();
    busbar::tell(*log_, record);
}

void RejectedList::make_room()
{
    std::vector<FileInList> files = lists_->files(StoreList::Rejected);
    files.erase(std::remove_if(
                    files.begin(), files.end(),
                    [](const FileInList& found) { return found.file->certificate() == nullptr; }),
                files.end());
    std::sort(files.begin(), files.end(), is_older);
    const std::size_t limit = lists_->limits().max_rejected;
    for (std::size_t i = 0; files.size() - i >= limit && i < files.size(); ++i) {
        if (lists_->storage().remove(files[i].name())) {
            records_->forget(StoreList::Rejected, files[i].file->thumbprint());
            tell(RecordKind::CertificateDiscarded, *files[i].file->certificate(),
                 "the oldest in rejected, was discarded: the list is full");
        }
    }
}

void RejectedList::save(const Certificate& certificate, DateTime now, std::string_view source)
{
    lists_->refresh(StoreList::Rejected, now);
    if (contains(certificate) || !may_act(now, source)) {
        return;
    }
    const StoreLimits& limits = lists_->limits();
    const bool is_full =
        lists_->count(StoreList::Rejected, EntryKind::Certificate) >= limits.max_rejected;
    const bool may_replace =
        limits.when_rejected_is_full == RejectedFull::OldestOut && limits.max_rejected != 0;
    // Files that were not read cannot be counted.
    if (lists_->is_cut(StoreList::Rejected) || (is_full && !may_replace)) {
        tell(RecordKind::CertificateDiscarded, certificate,
             "was discarded: rejected is full; delete a certificate there to make room");
        return;
    }
    const CertificateFolder& home = lists_->home(StoreList::Rejected, EntryKind::Certificate);
    const std::string file = store_file_name(certificate) + ".der";
    const auto saved =
        lists_->storage().replace(home.path_of(file), certificate.der(), FileAccess::Everyone);
    if (!saved && saved.error() == StorageError::Closed) {
        // It is not discarded for want of room, and a restart has an empty list for it.
        log_->write(LogLevel::Warning, "certificate store",
                    printable(certificate.subject()) + ", " + certificate.thumbprint_text() +
                        ", is not saved in rejected: the lists were replaced, and count from the "
                        "restart that is due; connect again after it");
        return;
    }
    if (!saved) {
        tell(RecordKind::CertificateDiscarded, certificate, "cannot be saved in rejected");
        return;
    }
    records_->know(StoreList::Rejected, {.name = file, .object = certificate}, home);
    tell(RecordKind::CertificateSaved, certificate,
         "was saved in rejected; to trust it, move it to trusted");
    make_room();
}

} // namespace busbar::crypto::detail
