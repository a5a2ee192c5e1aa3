#include "store_records.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include <busbar/core/string.hpp>
#include <busbar/core/variant.hpp>

#include "store_names.hpp"

namespace busbar::crypto::detail {

namespace {

using EntryKind = StoreEntry::Kind;

constexpr std::array looked_at{StoreList::Trusted, StoreList::Issuers, StoreList::Rejected};

std::string name_of(StoreList list)
{
    return std::string{name(list)};
}

EntryKind kind_of(const FolderFile& file)
{
    return file.certificate() != nullptr ? EntryKind::Certificate : EntryKind::RevocationList;
}

/// Adds the fields of a revocation list in addition to its lists.
void add_list_fields(std::vector<RecordField>& fields, const FolderFile& file,
                     const StoreEntry& entry)
{
    const auto add = [&](std::string_view name, Variant value) {
        fields.push_back({name, std::move(value)});
    };
    add("FileName", Variant{String{entry.file.substr(entry.file.rfind('/') + 1)}});
    add("IssuerName", Variant{String{issuer_common_name(*file.revocation_list())}});
    add("NextUpdate", Variant{entry.valid_to});
}

template <typename Map>
void copy_missing(const Map& some, const Map& others, Map& into)
{
    std::ranges::copy_if(some, std::inserter(into, into.end()),
                         [&](const auto& each) { return !others.contains(each.first); });
}

} // namespace

/// `from` is empty unless the entry was moved.
void StoreRecords::tell(RecordKind of_certificate, const std::string& what, const FolderFile& file,
                        StoreList list, std::string_view from) const
{
    const StoreEntry entry = entry_of({&lists_->home(list, kind_of(file)), &file});
    const bool is_list = entry.kind == EntryKind::RevocationList;
    const RecordKind of_list = of_certificate == RecordKind::CertificateRemoved
                                   ? RecordKind::RevocationListRemoved
                                   : RecordKind::RevocationListAdded;
    std::vector<RecordField> fields{{"ListName", Variant{String{name_of(list)}}}};
    if (!from.empty()) {
        fields.push_back({"FromListName", Variant{String{std::string{from}}}});
    }
    if (is_list) {
        add_list_fields(fields, file, entry);
    }
    Record record{is_list ? of_list : of_certificate, LogLevel::Info, "certificate store"};
    record.text = entry.subject + ", " + entry.thumbprint + ", was " + what;
    record.certificate = is_list ? std::span<const std::byte>{} : file.certificate()->der();
    record.fields = fields;
    busbar::tell(*log_, record);
}

void StoreRecords::know(StoreList list, FolderFile file, const CertificateFolder& folder)
{
    if (has_looked_) {
        std::string thumbprint = file.thumbprint();
        std::string path = folder.path_of(file.name);
        known(list).try_emplace(std::move(thumbprint), Known{std::move(path), std::move(file)});
    }
}

void StoreRecords::added(StoreList list, const FolderFile& file)
{
    know(list, file, lists_->home(list, kind_of(file)));
    tell(RecordKind::CertificateAdded, "added to " + name_of(list), file, list);
}

void StoreRecords::removed(StoreList list, const FolderFile& file)
{
    forget(list, file.thumbprint());
    tell(RecordKind::CertificateRemoved, "removed from " + name_of(list), file, list);
}

void StoreRecords::moved(StoreList from, StoreList to, const FolderFile& file)
{
    forget(from, file.thumbprint());
    know(to, file, lists_->home(to, kind_of(file)));
    tell(RecordKind::CertificateMoved, "moved from " + name_of(from) + " to " + name_of(to), file,
         to, name(from));
}

StoreRecords::KnownList StoreRecords::present(StoreList list)
{
    KnownList present;
    for (const FileInList& found : lists_->files(list)) {
        present.try_emplace(found.file->thumbprint(), Known{found.name(), *found.file});
    }
    for (const auto& [thumbprint, each] : known(list)) {
        if (lists_->may_hold(list, each.path)) {
            present.try_emplace(thumbprint, each);
        }
    }
    return present;
}

StoreRecords::Found StoreRecords::differences(DateTime now)
{
    Found found;
    for (const StoreList list : looked_at) {
        const auto at = static_cast<std::size_t>(list);
        lists_->refresh(list, now);
        found.present[at] = present(list);
        copy_missing(known(list), found.present[at], found.gone[at]);
        copy_missing(found.present[at], known(list), found.come[at]);
    }
    return found;
}

void StoreRecords::look(DateTime now)
{
    Found found = differences(now);
    const auto is_empty = [](const KnownList& each) { return each.empty(); };
    if (has_looked_ &&
        !(std::ranges::all_of(found.gone, is_empty) && std::ranges::all_of(found.come, is_empty))) {
        // A file that is moved between the readings of two lists is in both or in none.
        found = differences(now);
    }
    known_ = std::move(found.present);
    if (std::exchange(has_looked_, true)) {
        tell_found(found.gone, found.come);
    }
}

/// Reports a certificate that left one list and came into another as moved.
void StoreRecords::tell_found(KnownLists& gone, const KnownLists& come)
{
    for (const StoreList to : looked_at) {
        for (const auto& each : come[static_cast<std::size_t>(to)]) {
            const auto from = std::ranges::find_if(looked_at, [&](StoreList list) {
                return gone[static_cast<std::size_t>(list)].erase(each.first) != 0;
            });
            if (from == looked_at.end()) {
                added(to, each.second.file);
            } else {
                moved(*from, to, each.second.file);
            }
        }
    }
    for (const StoreList list : looked_at) {
        for (const auto& [thumbprint, each] : gone[static_cast<std::size_t>(list)]) {
            removed(list, each.file);
        }
    }
}

} // namespace busbar::crypto::detail
