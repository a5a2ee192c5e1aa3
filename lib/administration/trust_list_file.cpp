#include "trust_list_file.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>
#include <busbar/server/running_server.hpp>

#include "giving_way.hpp"
#include "method_arguments.hpp"
#include "method_record.hpp"
#include "permissions.hpp"

namespace busbar::administration::detail {

namespace {

using server::MethodCall;

// Limits for one list and all sessions together: number of open files, and their content in
// multiples of the largest list. The user with the largest share gives way to one with a smaller
// share.

constexpr std::size_t max_open = 16;
constexpr std::size_t max_open_lists = 4;
/// Maximum number of bytes in one answer; the client asks again for the rest (Part 20, 4.2.4).
constexpr std::size_t max_read = 65'536;

// Modes of Open (Part 20, 4.2.2).
constexpr std::uint8_t mode_read = 1;
constexpr std::uint8_t mode_write_and_erase = 6;

// Reasons, see CallResult::reason.

constexpr const char* no_handle = "this session has no trust list open by this handle";
constexpr const char* for_reading = "the trust list is open for reading";

} // namespace

TrustListFile::TrustListFile(const TrustListNeeds& needs, std::size_t group)
    : needs_{needs}, group_{group}
{
}

void TrustListFile::bind(model::NodeIndex node, std::string_view name,
                         void (TrustListFile::*function)(MethodCall))
{
    model::AddressSpace& space = needs_.server.address_space();
    needs_.table.bind_method(space, child_of(space, node, name), [this, function](MethodCall call) {
        expire();
        (this->*function)(std::move(call));
    });
}

void TrustListFile::attach(model::NodeIndex node)
{
    close_and_update_ = child_of(needs_.server.address_space(), node, "CloseAndUpdate");
    bind_values(node);
    bind(node, "Open", &TrustListFile::open);
    bind(node, "OpenWithMasks", &TrustListFile::open_with_masks);
    bind(node, "Close", &TrustListFile::close);
    bind(node, "Read", &TrustListFile::read);
    bind(node, "Write", &TrustListFile::write);
    bind(node, "GetPosition", &TrustListFile::get_position);
    bind(node, "SetPosition", &TrustListFile::set_position);
    bind(node, "CloseAndUpdate", &TrustListFile::close_and_update);
    bind(node, "AddCertificate", &TrustListFile::add_certificate);
    bind(node, "RemoveCertificate", &TrustListFile::remove_certificate);
}

void TrustListFile::bind_values(model::NodeIndex node)
{
    model::AddressSpace& space = needs_.server.address_space();
    const auto bind_one = [&](std::string_view name, NodeTable::Value value) {
        needs_.table.bind_value(space, child_of(space, node, name), std::move(value));
    };
    // Not meaningful for trust lists (Part 12, 7.8.2.1).
    bind_one("Size", [] { return DataValue{status::Bad_NotSupported}; });
    bind_one("Writable", [] { return DataValue{Variant{true}}; });
    bind_one("UserWritable", [] { return DataValue{Variant{true}}; });
    bind_one("OpenCount", [this] {
        expire();
        return DataValue{Variant{static_cast<std::uint16_t>(open_.size())}};
    });
    bind_one("LastUpdateTime", [this] {
        DateTime last{};
        for (const char* folder :
             {"trusted/certs", "trusted/crl", "issuers/certs", "issuers/crl"}) {
            const auto entry = group().store->storage().entry(folder);
            last = entry ? std::max(last, entry->modified) : last;
        }
        return DataValue{Variant{last}};
    });
}

void TrustListFile::expire()
{
    std::erase_if(open_, [&](const Open& open) { return !is_there(needs_.server, open.holder); });
    const Holder* const owner = needs_.transaction.owner();
    if (owner != nullptr && !is_there(needs_.server, *owner)) {
        needs_.transaction.cancel(status::Bad_SessionClosed);
    }
}

bool TrustListFile::is_open_for_writing() const
{
    return std::any_of(open_.begin(), open_.end(),
                       [](const Open& open) { return open.is_writing; });
}

TrustListFile::Open* TrustListFile::find(const MethodCall& call)
{
    const auto handle = call.input<std::uint32_t>(0);
    const Holder holder = holder_of(needs_.server, call);
    const auto found = std::find_if(open_.begin(), open_.end(), [&](const Open& open) {
        return open.handle == handle && open.holder == holder;
    });
    return found == open_.end() ? nullptr : &*found;
}

void TrustListFile::forget(const Open& open)
{
    std::erase_if(open_,
                  [handle = open.handle](const Open& each) { return each.handle == handle; });
}

bool TrustListFile::make_room(const Holder& holder, std::size_t bytes)
{
    const auto places = [](const Open& each) { return std::size_t{each.is_writing ? 0U : 1U}; };
    const auto sizes = [](const Open& each) { return each.is_writing ? 0 : each.bytes.size(); };
    const auto oldest = [](const Open&) { return 0; };
    for (;;) {
        const std::size_t held = std::accumulate(
            open_.begin(), open_.end(), bytes,
            [](std::size_t sum, const Open& each) { return sum + each.bytes.size(); });
        const bool is_too_much = held > max_open_lists * needs_.files.max_trust_list_size;
        if (!is_too_much && open_.size() < max_open) {
            return true;
        }
        const auto loser = is_too_much ? find_giving_way(open_, holder, bytes, sizes, oldest)
                                       : find_giving_way(open_, holder, 1, places, oldest);
        if (loser == open_.end()) {
            return false;
        }
        open_.erase(loser);
    }
}

bool TrustListFile::keep(MethodCall& call, Open open)
{
    open.holder = holder_of(needs_.server, call);
    if (!make_room(open.holder, open.bytes.size())) {
        call.fail(status::Bad_TooManyOperations,
                  "too many sessions have the trust list open; try again later");
        return false;
    }
    open.handle = last_handle_ + 1;
    open.version = group().version;
    auto outputs = one_output(Variant{open.handle});
    open_.push_back(std::move(open));
    ++last_handle_;
    call.succeed(std::move(outputs));
    return true;
}

/// Part 12, 7.8.2.2.
void TrustListFile::open(MethodCall call)
{
    const auto mode = call.input<std::uint8_t>(0);
    if (mode == mode_read) {
        return open_reading(std::move(call), all_lists);
    }
    if (mode != mode_write_and_erase) {
        return call.fail(status::Bad_NotSupported,
                         "found mode " + std::to_string(mode) +
                             ", expected 1 (read) or 6 (write and erase)");
    }
    // Refuse users who may only look: they would keep administrators out.
    if (!may_call(needs_.server.address_space(), close_and_update_, call.user())) {
        return call.fail(status::Bad_UserAccessDenied, "only SecurityAdmin changes trust lists");
    }
    if (is_open_for_writing()) {
        return call.fail(status::Bad_NotWritable,
                         "another session has the trust list open for writing; try again later");
    }
    TransactionEntry entry{needs_.transaction, holder_of(needs_.server, call)};
    if (entry.status().is_bad()) {
        return call.fail(entry.status(), other_transaction);
    }
    if (keep(call, {0, {}, true, {}, 0, 0})) {
        entry.keep();
    }
}

/// Part 12, 7.8.2.3.
void TrustListFile::open_with_masks(MethodCall call)
{
    const auto masks = call.input<std::uint32_t>(0);
    open_reading(std::move(call), masks);
}

void TrustListFile::open_reading(MethodCall call, std::uint32_t masks)
{
    auto bytes = bytes_of(group().store->trust_list(needs_.clock.now()), masks);
    static_cast<void>(keep(call, {0, {}, false, std::move(bytes), 0, 0}));
}

void TrustListFile::close(MethodCall call)
{
    const Open* const open = find(call);
    if (open == nullptr) {
        return call.fail(status::Bad_InvalidArgument, no_handle);
    }
    forget(*open);
    call.succeed();
}

/// Part 12, 7.8.2.4; Part 20, 4.2.4.
void TrustListFile::read(MethodCall call)
{
    Open* const open = find(call);
    const auto length = call.input<std::int32_t>(1);
    if (open == nullptr || length < 0) {
        return call.fail(status::Bad_InvalidArgument,
                         open == nullptr ? no_handle : "found a negative length");
    }
    if (open->is_writing || open->version != group().version) {
        return call.fail(status::Bad_InvalidState,
                         open->is_writing ? "the trust list is open for writing"
                                          : "the trust list has changed; open it again");
    }
    const std::size_t count =
        std::min({open->bytes.size() - open->position, static_cast<std::size_t>(length), max_read});
    const std::span<const std::byte> piece = std::span{open->bytes}.subspan(open->position, count);
    auto outputs = one_output(Variant{ByteString{piece}});
    open->position += count;
    call.succeed(std::move(outputs));
}

void TrustListFile::write(MethodCall call)
{
    Open* const open = find(call);
    if (open == nullptr) {
        return call.fail(status::Bad_InvalidArgument, no_handle);
    }
    if (!open->is_writing) {
        return call.fail(status::Bad_InvalidState, for_reading);
    }
    const std::span<const std::byte> bytes = bytes_input(call, 1);
    if (bytes.size() > needs_.files.max_trust_list_size - open->position) {
        return call.fail(status::Bad_RequestTooLarge, too_large());
    }
    open->bytes.resize(std::max(open->bytes.size(), open->position + bytes.size()));
    std::copy(bytes.begin(), bytes.end(),
              open->bytes.begin() + static_cast<std::ptrdiff_t>(open->position));
    open->position += bytes.size();
    call.succeed();
}

void TrustListFile::get_position(MethodCall call)
{
    const Open* const open = find(call);
    if (open == nullptr) {
        return call.fail(status::Bad_InvalidArgument, no_handle);
    }
    call.succeed(one_output(Variant{static_cast<std::uint64_t>(open->position)}));
}

void TrustListFile::set_position(MethodCall call)
{
    Open* const open = find(call);
    if (open == nullptr) {
        return call.fail(status::Bad_InvalidArgument, no_handle);
    }
    const auto position = call.input<std::uint64_t>(1);
    open->position = static_cast<std::size_t>(
        std::min(position, static_cast<std::uint64_t>(open->bytes.size())));
    call.succeed();
}

/// Part 12, 7.8.2.5.
void TrustListFile::close_and_update(MethodCall call)
{
    const Open* const open = find(call);
    if (open == nullptr) {
        return call.fail(status::Bad_InvalidArgument, no_handle);
    }
    if (!open->is_writing) {
        return call.fail(status::Bad_InvalidState, for_reading);
    }
    crypto::TrustListParts parts;
    auto list = merge(open->bytes, needs_.transaction.trust_list(group_), parts);
    if (!list) {
        forget(*open);
        return refuse_call(call, list.error());
    }
    if (const auto refused = crypto::check_trust_list(*list, needs_.clock.now(), group().purpose)) {
        forget(*open);
        return refuse_call(call, *refused);
    }
    auto outputs = one_output(Variant{true});
    needs_.transaction.set_trust_list(group_, *std::move(list), parts);
    forget(*open);
    call.succeed(std::move(outputs));
}

std::string TrustListFile::too_large() const
{
    return "a trust list has at most " + std::to_string(needs_.files.max_trust_list_size) +
           " bytes";
}

StatusCode TrustListFile::check_single_change() const
{
    if (is_open_for_writing()) {
        return status::Bad_InvalidState;
    }
    return needs_.transaction.is_active() ? status::Bad_TransactionPending : status::Good;
}

void TrustListFile::tell(const MethodCall& call, const Refusal* refusal)
{
    busbar::detail::attempt([&] {
        const std::array fields{RecordField{"TrustListId", Variant{group().trust_list_id}}};
        tell_method(needs_.log, RecordKind::TrustListUpdated, call,
                    refusal != nullptr ? refusal->status : StatusCode{status::Good}, refusal,
                    fields);
    });
}

void TrustListFile::refuse_call(MethodCall& call, const Refusal& refusal)
{
    tell(call, &refusal);
    answer_with(call, refusal);
}

/// Part 12, 7.8.2.6. Takes effect at once and removes the certificate from the rejected list.
void TrustListFile::add_certificate(MethodCall call)
{
    if (const StatusCode state = check_single_change(); state.is_bad()) {
        return call.fail(state, state == status::Bad_InvalidState
                                    ? "the trust list is open for writing; close it first"
                                    : other_transaction);
    }
    const std::span<const std::byte> der = bytes_input(call, 0);
    auto certificate = crypto::Certificate::parse(der);
    // CA certificates need revocation lists, which this Method cannot take.
    if (!certificate || !call.input<bool>(1)) {
        return call.fail(status::Bad_CertificateInvalid,
                         certificate ? "this Method adds trusted certificates only; add issuers "
                                       "with their revocation lists by writing the trust list"
                                     : "the certificate cannot be read, expected DER");
    }
    crypto::CertificateStore& store = *group().store;
    crypto::TrustList list = store.trust_list(needs_.clock.now());
    list.trusted.insert(list.trusted.begin(), *certificate);
    if (bytes_of(list, all_lists).size() > needs_.files.max_trust_list_size) {
        return call.fail(status::Bad_RequestTooLarge, too_large());
    }
    // Only trusted CAs matter here, not other clients.
    crypto::TrustList alone = list;
    std::erase_if(alone.trusted, [&](const crypto::Certificate& each) {
        return !(each == *certificate) && !crypto::is_authority(each);
    });
    if (const auto refused = crypto::check_trust_list(alone, needs_.clock.now(), group().purpose)) {
        return refuse_call(call, *refused);
    }
    if (auto added = trust(*certificate); !added) {
        return refuse_call(call, added.error());
    }
    ++group().version;
    tell(call, nullptr);
    tell_changed();
    call.succeed();
}

/// Moves a rejected certificate, so that the log shows a single change.
Checked<void> TrustListFile::trust(const crypto::Certificate& certificate)
{
    crypto::CertificateStore& store = *group().store;
    const std::string thumbprint = certificate.thumbprint_text();
    const auto has = [&](crypto::StoreList list) {
        const auto entries = store.list(list);
        return std::any_of(entries.begin(), entries.end(), [&](const crypto::StoreEntry& entry) {
            return entry.thumbprint == thumbprint;
        });
    };
    if (has(crypto::StoreList::Rejected) && !has(crypto::StoreList::Trusted)) {
        return store.move(thumbprint, crypto::StoreList::Rejected, crypto::StoreList::Trusted);
    }
    auto added = store.add(crypto::StoreList::Trusted, certificate.der());
    return added ? Checked<void>{} : refuse(std::move(added).error());
}

Checked<void> TrustListFile::take_out(const crypto::Certificate& certificate, bool is_trusted)
{
    const crypto::TrustList before = group().store->trust_list(needs_.clock.now());
    crypto::TrustList list = before;
    const bool was_sound =
        !crypto::check_trust_list(list, needs_.clock.now(), group().purpose).has_value();
    std::erase(is_trusted ? list.trusted : list.issuers, certificate);
    const auto is_of_it = [&](const crypto::RevocationList& crl) {
        return crl.names_issuer(certificate);
    };
    std::erase_if(is_trusted ? list.trusted_crls : list.issuer_crls, is_of_it);
    if (was_sound && crypto::check_trust_list(list, needs_.clock.now(), group().purpose)) {
        return refuse(
            {status::Bad_CertificateChainIncomplete, "trust list",
             "another certificate of the list was issued by " + printable(certificate.subject()),
             "Part 12, 7.8.2.7", "Remove that one first"});
    }
    FileTransaction change{*needs_.files.files, transaction_folder};
    const crypto::TrustListParts parts{is_trusted, is_trusted, !is_trusted, !is_trusted};
    auto done = prepare_files(change);
    done = done ? group().store->stage(list, parts, change, group().folder) : done;
    done = done ? commit_files(change) : done;
    if (done) {
        busbar::detail::attempt([&] { // reporting may fail, the removal stays
            group().store->tell_changes(before, list);
        });
    }
    return done;
}

/// Part 12, 7.8.2.7. Takes effect at once.
void TrustListFile::remove_certificate(MethodCall call)
{
    if (const StatusCode state = check_single_change(); state.is_bad()) {
        return call.fail(state, state == status::Bad_InvalidState
                                    ? "the trust list is open for writing; close it first"
                                    : other_transaction);
    }
    const std::string thumbprint = crypto::spelled_thumbprint(text_view(call, 0));
    const bool is_trusted = call.input<bool>(1);
    const crypto::TrustList& list = group().store->trust_list(needs_.clock.now());
    const auto& certificates = is_trusted ? list.trusted : list.issuers;
    const auto found =
        std::find_if(certificates.begin(), certificates.end(), [&](const crypto::Certificate& c) {
            return c.thumbprint_text() == thumbprint;
        });
    if (found == certificates.end()) {
        return call.fail(status::Bad_InvalidArgument,
                         std::string{is_trusted ? "trusted" : "issuers"} +
                             " has no certificate with the thumbprint " + printable(thumbprint));
    }
    // Copy it: the store reads its list again on the way.
    // NOLINTNEXTLINE(performance-unnecessary-copy-initialization)
    const crypto::Certificate certificate = *found;
    if (const auto done = take_out(certificate, is_trusted); !done) {
        return refuse_call(call, done.error());
    }
    ++group().version;
    tell(call, nullptr);
    tell_changed();
    call.succeed();
}

} // namespace busbar::administration::detail
