#include "transaction.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/status_codes.hpp>

namespace busbar::administration::detail {

namespace {

void add_once(std::vector<NodeId>& ids, const NodeId& id)
{
    if (std::find(ids.begin(), ids.end(), id) == ids.end()) {
        ids.push_back(id);
    }
}

crypto::TrustListParts both(const crypto::TrustListParts& a, const crypto::TrustListParts& b)
{
    return {a.trusted || b.trusted, a.trusted_crls || b.trusted_crls, a.issuers || b.issuers,
            a.issuer_crls || b.issuer_crls};
}

Unexpected<Refusal> refuse_files(StorageError error, bool is_decided = false)
{
    return refuse({status::Bad_ResourceUnavailable, "transaction",
                   "the files cannot be written: " + std::string{text(error)} +
                       (is_decided ? "; the rest is written as soon as they can" : ""),
                   "", "Check the free space and the permissions of the folder"});
}

} // namespace

Checked<void> prepare_files(FileTransaction& change)
{
    const auto ready = change.recover();
    return ready ? Checked<void>{} : Checked<void>{refuse_files(ready.error())};
}

Checked<void> commit_files(FileTransaction& change)
{
    Stored<void> done = not_stored(StorageError::Failed);
    const StatusCode thrown = busbar::detail::caught([&] { done = change.commit(); });
    // A decided change is finished as soon as the files can be written again.
    if (done || (change.is_decided() && change.recover())) {
        return {};
    }
    return thrown.is_bad()
               ? refuse({thrown, "transaction", "the files were not written", "", "Try again"})
               : refuse_files(done.error(), change.is_decided());
}

StatusCode Transaction::enter(const Holder& holder)
{
    if (owner_) {
        return *owner_ == holder ? status::Good : status::Bad_TransactionPending;
    }
    owner_ = holder;
    has_begun_ = true;
    start_time_ = clock_.now();
    end_time_ = {};
    result_ = status::Good;
    trust_lists_.clear();
    affected_groups_.clear();
    errors_.clear();
    return status::Good;
}

StatusCode Transaction::check_end(const Holder& holder) const
{
    if (!owner_) {
        return status::Bad_NothingToDo;
    }
    return *owner_ == holder ? status::Good : status::Bad_SessionIdInvalid;
}

void Transaction::set_trust_list(std::size_t group, crypto::TrustList list,
                                 crypto::TrustListParts parts)
{
    add_once(trust_lists_, groups_[group].trust_list_id);
    add_once(affected_groups_, groups_[group].id);
    const auto before = std::find_if(lists_.begin(), lists_.end(),
                                     [&](const NewList& each) { return each.group == group; });
    if (before != lists_.end()) {
        *before = {group, std::move(list), both(parts, before->parts)};
    } else {
        lists_.push_back({group, std::move(list), parts});
    }
}

void Transaction::set_own_certificate(crypto::OwnCertificate own)
{
    add_once(affected_groups_, groups_.front().id);
    own_ = std::move(own);
    is_own_deleted_ = false;
}

void Transaction::delete_own_certificate()
{
    add_once(affected_groups_, groups_.front().id);
    own_.reset();
    is_own_deleted_ = true;
}

crypto::TrustList Transaction::trust_list(std::size_t group) const
{
    for (const NewList& each : lists_) {
        if (each.group == group) {
            return each.list;
        }
    }
    return groups_[group].store->trust_list(clock_.now());
}

Checked<void> Transaction::write(FileTransaction& change, std::string_view application_uri)
{
    if (auto ready = prepare_files(change); !ready) {
        return ready;
    }
    if (is_own_deleted_) {
        Refusal refusal{status::Bad_InvalidState, "transaction",
                        "the server's certificate would be deleted without a replacement",
                        "Part 12, 7.10.9", "Call CreateSelfSignedCertificate or UpdateCertificate"};
        errors_.push_back(
            {groups_.front().id, refusal.status, LocalizedText{"en", String{text(refusal)}}});
        return refuse(std::move(refusal));
    }
    for (const NewList& each : lists_) {
        const CertificateGroup& group = groups_[each.group];
        if (auto staged = group.store->stage(each.list, each.parts, change, group.folder);
            !staged) {
            errors_.push_back({group.trust_list_id, staged.error().status,
                               LocalizedText{"en", String{text(staged.error())}}});
            return staged;
        }
    }
    if (own_) {
        const crypto::OwnCertificateStore store{*files_.files};
        if (auto staged = store.stage(*own_, application_uri, change); !staged) {
            errors_.push_back({groups_.front().id, staged.error().status,
                               LocalizedText{"en", String{text(staged.error())}}});
            return staged;
        }
    }
    return commit_files(change);
}

Checked<Transaction::Changed> Transaction::apply(std::string_view application_uri)
{
    Changed changed;
    std::vector<crypto::TrustList> before;
    for (const NewList& each : lists_) {
        before.push_back(groups_[each.group].store->trust_list(clock_.now()));
        changed.groups.push_back(each.group);
    }
    FileTransaction change{*files_.files, transaction_folder};
    if (auto written = write(change, application_uri); !written) {
        if (written.error().status != status::Bad_OutOfMemory) {
            end(written.error().status);
        }
        return refuse(std::move(written).error());
    }
    for (std::size_t i = 0; i < lists_.size(); ++i) {
        const NewList& each = lists_[i];
        ++groups_[each.group].version;
        busbar::detail::attempt([&] { // reporting may fail, the change stays
            groups_[each.group].store->tell_changes(before[i], each.list);
        });
    }
    if (own_) {
        // Rename the new key; if this fails, a later load does it.
        busbar::detail::attempt([&] {
            const crypto::OwnCertificateStore store{*files_.files};
            static_cast<void>(store.load(application_uri));
        });
        changed.own = std::move(own_);
    }
    end(status::Good);
    return changed;
}

void Transaction::cancel(StatusCode why)
{
    if (owner_) {
        end(why);
    }
}

void Transaction::end(StatusCode result)
{
    owner_.reset();
    lists_.clear();
    own_.reset();
    is_own_deleted_ = false;
    end_time_ = clock_.now();
    result_ = result;
}

} // namespace busbar::administration::detail

namespace busbar::administration {

Configured<void> finish_changes(Storage& files)
{
    FileTransaction interrupted{files, detail::transaction_folder};
    const auto finished = interrupted.recover();
    // Nothing can have begun on a medium that is not present yet.
    if (finished || finished.error() == StorageError::Away) {
        return {};
    }
    return misconfigured(files.place(detail::transaction_folder),
                         "an interrupted change cannot be finished: " +
                             std::string{text(finished.error())},
                         status_of(finished.error()));
}

Configured<void> remove_files(Storage& files, std::span<const std::string_view> names,
                              std::span<const std::string_view> folders)
{
    constexpr std::size_t most = 10'000;
    const auto failed = [&](std::string_view name, StorageError error) {
        return misconfigured(files.place(name), "cannot be removed: " + std::string{text(error)},
                             status_of(error));
    };
    FileTransaction removal{files, detail::transaction_folder};
    for (const std::string_view name : names) {
        if (const auto removed = removal.remove(name); !removed) {
            return failed(name, removed.error());
        }
    }
    for (const std::string_view folder : folders) {
        const auto listing = files.list(folder, most);
        if (!listing && listing.error() != StorageError::NotFound) {
            return failed(folder, listing.error());
        }
        for (const StorageEntry& each : listing ? listing->entries : std::vector<StorageEntry>{}) {
            if (each.kind == StorageEntry::Kind::Folder) {
                continue;
            }
            const std::string name = std::string{folder} + "/" + each.name;
            if (const auto removed = removal.remove(name); !removed) {
                return failed(name, removed.error());
            }
        }
    }
    const auto done = removal.commit();
    return done || removal.is_decided() ? Configured<void>{}
                                        : failed(detail::transaction_folder, done.error());
}

} // namespace busbar::administration
