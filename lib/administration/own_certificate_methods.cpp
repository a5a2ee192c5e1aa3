#include "own_certificate_methods.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/crypto/signing_request.hpp>
#include <busbar/types/ids.hpp>

#include "method_arguments.hpp"
#include "method_record.hpp"

namespace busbar::administration::detail {

namespace {

using server::MethodCall;

constexpr std::size_t min_nonce = 32;

// Reasons, see CallResult::reason.

constexpr const char* no_such_slot =
    "expected the group DefaultApplicationGroup and the type RsaSha256ApplicationCertificateType";
constexpr const char* makes_key = "a private key is being generated; try again when it is done";
constexpr const char* no_own = "this server has no certificate";
constexpr const char* no_certificate =
    "these values cannot be put into a certificate; expected names of at most 64 bytes, a country "
    "of two letters, and valid host names and IP addresses";

/// Concatenates the ByteStrings in argument number `index`.
std::vector<std::byte> concatenated(const MethodCall& call, std::size_t index)
{
    std::vector<std::byte> all;
    if (const auto* const list = call.inputs()[index].array_if<ByteString>()) {
        for (const ByteString& each : *list) {
            all.insert(all.end(), each.span().begin(), each.span().end());
        }
    }
    return all;
}

std::vector<std::string> strings_input(const MethodCall& call, std::size_t index)
{
    std::vector<std::string> all;
    if (const auto* const list = call.inputs()[index].array_if<String>()) {
        for (const String& each : *list) {
            all.push_back(each.str());
        }
    }
    return all;
}

Unexpected<Refusal> refuse_certificate(StatusCode status, std::string found,
                                       std::string remedy = {})
{
    return refuse(
        {status, "own certificate", std::move(found), "Part 12, 7.10.5", std::move(remedy)});
}

} // namespace

StatusCode OwnCertificateMethods::check_slot(const MethodCall& call) const
{
    const NodeId group = call.input<NodeId>(0);
    const NodeId type = call.input<NodeId>(1);
    const bool is_group =
        group.is_null() ||
        group.is(id::ServerConfiguration_CertificateGroups_DefaultApplicationGroup);
    return is_group && type.is(certificate_type) ? status::Good : status::Bad_InvalidArgument;
}

Checked<crypto::OwnCertificate> OwnCertificateMethods::own_of(const MethodCall& call) const
{
    const std::span<const std::byte> leaf = bytes_input(call, 2);
    std::vector<std::byte> chain{leaf.begin(), leaf.end()};
    const std::vector<std::byte> issuers = concatenated(call, 3);
    chain.insert(chain.end(), issuers.begin(), issuers.end());
    auto certificates = crypto::parse_chain(chain);
    if (!certificates || !crypto::Certificate::parse(leaf)) {
        return refuse_certificate(status::Bad_CertificateInvalid,
                                  "the certificates cannot be read, expected DER");
    }
    const std::string_view format = text_view(call, 4);
    const crypto::OwnCertificateStore store{*needs_.files.files};
    const std::string& uri = needs_.server.config().application_uri;
    if (format.empty()) {
        auto own = store.match(chain, uri);
        // Another key has a status of its own: Part 12, 7.10.5, Table 88.
        return own || own.error().status != status::Bad_CertificateInvalid
                   ? own
                   : refuse_certificate(status::Bad_SecurityChecksFailed, text(own.error()));
    }
    if (format != private_key_format) {
        return refuse_certificate(status::Bad_NotSupported,
                                  "the format " + printable(format) +
                                      " of the private key is not supported",
                                  "Send it as PEM");
    }
    auto key = crypto::PrivateKey::parse(bytes_input(call, 5));
    if (!key || !key->belongs_to(certificates->front())) {
        return refuse_certificate(
            status::Bad_SecurityChecksFailed,
            "the private key cannot be read or belongs to another certificate");
    }
    return crypto::OwnCertificate{*std::move(certificates), *std::move(key)};
}

/// Checks the certificate; its issuers must be in the trust list or in the transaction.
Checked<void> OwnCertificateMethods::check_own(const crypto::OwnCertificate& own) const
{
    crypto::TrustList list = needs_.transaction.trust_list(0);
    list.trusted = {own.certificates.front()};
    const crypto::TrustList known = needs_.transaction.trust_list(0);
    list.issuers.insert(list.issuers.end(), known.trusted.begin(), known.trusted.end());
    auto refused =
        crypto::check_trust_list(list, needs_.clock.now(), crypto::CertificatePurpose::Application);
    return refused ? Checked<void>{refuse(*std::move(refused))} : Checked<void>{};
}

/// Part 12, 7.10.5.
void OwnCertificateMethods::update(MethodCall call)
{
    if (const StatusCode slot = check_slot(call); slot.is_bad()) {
        return call.fail(slot, no_such_slot);
    }
    if (needs_.transaction.is_active() &&
        *needs_.transaction.owner() != holder_of(needs_.server, call)) {
        return call.fail(status::Bad_TransactionPending, other_transaction);
    }
    if (is_making_key()) {
        return call.fail(status::Bad_InvalidState, makes_key);
    }
    auto own = own_of(call);
    if (!own) {
        return refuse_call(call, own.error());
    }
    if (const auto checked = check_own(*own); !checked) {
        return refuse_call(call, checked.error());
    }
    auto outputs = one_output(Variant{true});
    TransactionEntry entry{needs_.transaction, holder_of(needs_.server, call)};
    needs_.transaction.set_own_certificate(*std::move(own));
    entry.keep();
    call.succeed(std::move(outputs));
}

void OwnCertificateMethods::run_slowly(const std::shared_ptr<MethodCall>& call,
                                       std::function<void()> work, std::function<void()> finish)
{
    const auto making_key = std::make_shared<char>();
    making_key_ = making_key;
    needs_.table.run(
        needs_.worker,
        [call, work = std::move(work)] {
            if (!call->is_abandoned()) {
                work();
            }
        },
        [this, call, making_key, holder = holder_of(needs_.server, *call),
         finish = std::move(finish)](StatusCode done) {
            making_key_.reset();
            StatusCode status = done;
            if (done.is_good()) {
                status = check_wanted(*call, holder);
            }
            if (status.is_good()) {
                status = busbar::detail::guarded(needs_.log, "a Method of administration", finish);
            }
            if (status.is_bad()) {
                call->fail(status);
            }
        });
}

StatusCode OwnCertificateMethods::check_wanted(const MethodCall& call, const Holder& holder) const
{
    return call.is_abandoned()
               ? StatusCode{status::Bad_Timeout}
               : check_still(needs_.server, holder, call.object_id(), call.method_id());
}

/// Part 12, 7.10.10. A new key stays in the files until its certificate arrives. It is put there on
/// the server's thread, where the client still waits: a key that nothing waits for would replace
/// the one for which a certificate is being issued.
void OwnCertificateMethods::create_signing_request(MethodCall call)
{
    if (const StatusCode slot = check_slot(call); slot.is_bad()) {
        return call.fail(slot, no_such_slot);
    }
    if (is_making_key()) {
        return call.fail(status::Bad_InvalidState, makes_key);
    }
    const bool needs_key = call.input<bool>(3);
    const std::span<const std::byte> nonce = bytes_input(call, 4);
    const auto& identity = needs_.server.config().identity;
    if (!identity || (needs_key && nonce.size() < min_nonce)) {
        return identity ? call.fail(status::Bad_InvalidArgument,
                                    "a new private key requires a nonce of at least 32 bytes")
                        : call.fail(status::Bad_InvalidState, no_own);
    }
    auto subject =
        with_names(crypto::subject_of(identity->certificates.front()), text_view(call, 2));
    if (!subject) {
        return refuse_call(call, subject.error());
    }
    crypto::OwnCertificateSettings settings;
    settings.subject = *std::move(subject);
    settings.key_bits = needs_.files.key_bits;
    crypto::add_entropy(nonce);
    using Made = Checked<crypto::SigningRequest>;
    const auto made = std::make_shared<Made>(refuse({}));
    const auto shared = std::make_shared<MethodCall>(std::move(call));
    run_slowly(
        shared,
        [this, made, settings, needs_key] {
            const crypto::OwnCertificateStore store{*needs_.files.files};
            using Key = crypto::OwnCertificateStore::RequestKey;
            *made = store.make_signing_request(settings, needs_key ? Key::New : Key::Present);
        },
        [this, made, shared] {
            if (!*made) {
                return refuse_call(*shared, made->error());
            }
            auto outputs = one_output(Variant{ByteString{(*made)->request}});
            if ((*made)->new_key) {
                const crypto::OwnCertificateStore store{*needs_.files.files};
                if (const auto kept = store.keep_request_key(*(*made)->new_key); !kept) {
                    return refuse_call(*shared, kept.error());
                }
            }
            shared->succeed(std::move(outputs));
        });
}

/// Part 12, 7.10.6. The slot must be empty, as after DeleteCertificate in the same transaction.
void OwnCertificateMethods::create_self_signed(MethodCall call)
{
    if (const StatusCode slot = check_slot(call); slot.is_bad()) {
        return call.fail(slot, no_such_slot);
    }
    if (needs_.transaction.is_active() &&
        *needs_.transaction.owner() != holder_of(needs_.server, call)) {
        return call.fail(status::Bad_TransactionPending, other_transaction);
    }
    if (refuses_another(call)) {
        return;
    }
    const auto& identity = needs_.server.config().identity;
    if (is_making_key() || !identity || !needs_.transaction.is_own_deleted()) {
        return call.fail(
            status::Bad_InvalidState,
            is_making_key() ? makes_key
            : !identity     ? no_own
                        : "the present certificate must be deleted first, in the same transaction");
    }
    crypto::CertificateSubject base;
    base.application_uri = needs_.server.config().application_uri;
    auto subject = with_names(std::move(base), text_view(call, 2));
    if (!subject) {
        return refuse_call(call, subject.error());
    }
    subject->dns_names = strings_input(call, 3);
    subject->ip_addresses = strings_input(call, 4);
    const auto days = call.input<std::uint16_t>(5);
    const std::uint32_t bits = call.input<std::uint16_t>(6);
    constexpr std::uint32_t min_bits = 2048;
    constexpr std::uint32_t max_bits = 4096;
    if (bits != 0 && (bits < min_bits || bits > max_bits)) {
        return call.fail(status::Bad_OutOfRange,
                         "a key of " + std::to_string(bits) + " bits, expected 2048 to 4096");
    }
    constexpr std::int64_t day = 86'400 * DateTime::ticks_per_second;
    subject->valid_days = (days == 0 ? crypto::default_valid_days : days) + 1;
    subject->valid_from = DateTime{needs_.clock.now().ticks - day};
    using Made = Result<crypto::OwnCertificate>;
    const auto made = std::make_shared<Made>(Unexpected{StatusCode{status::Bad_InternalError}});
    const Holder holder = holder_of(needs_.server, call);
    const auto shared = std::make_shared<MethodCall>(std::move(call));
    run_slowly(
        shared,
        [made, wanted = *subject, bits = bits == 0 ? needs_.files.key_bits : bits] {
            auto key = crypto::PrivateKey::generate(bits);
            auto certificate =
                key ? crypto::create_self_signed(*key, wanted) : Unexpected{key.error()};
            *made = certificate
                        ? Made{crypto::OwnCertificate{{*std::move(certificate)}, *std::move(key)}}
                        : Made{Unexpected{certificate.error()}};
        },
        [this, made, shared, holder] {
            if (!*made) {
                return shared->fail(made->error(), no_certificate);
            }
            if (!needs_.transaction.is_own_deleted() ||
                *needs_.transaction.owner() != holder) { // the transaction has ended since
                return shared->fail(status::Bad_InvalidState,
                                    "the transaction ended while the key was being generated");
            }
            auto outputs = one_output(Variant{ByteString{(*made)->certificates.front().der()}});
            needs_.transaction.set_own_certificate(**made);
            shared->succeed(std::move(outputs));
        });
}

/// Part 12, 7.10.7. The server needs a certificate: a successor must follow in the same
/// transaction.
void OwnCertificateMethods::remove(MethodCall call)
{
    if (const StatusCode slot = check_slot(call); slot.is_bad()) {
        return call.fail(slot, no_such_slot);
    }
    if (refuses_another(call)) {
        return;
    }
    TransactionEntry entry{needs_.transaction, holder_of(needs_.server, call)};
    if (entry.status().is_bad()) {
        return call.fail(entry.status(), other_transaction);
    }
    needs_.transaction.delete_own_certificate();
    entry.keep();
    call.succeed();
}

/// Part 12, 7.10.8.
void OwnCertificateMethods::get(MethodCall call)
{
    const NodeId group = call.input<NodeId>(0);
    const bool is_known =
        std::any_of(needs_.transaction.groups().begin(), needs_.transaction.groups().end(),
                    [&](const CertificateGroup& each) { return each.id == group; });
    if (!is_known && !group.is_null()) {
        return call.fail(status::Bad_InvalidArgument, "there is no such certificate group");
    }
    const auto& identity = needs_.server.config().identity;
    Array<ByteString> certificates;
    certificates.clear();
    const bool has_own =
        identity && (group.is_null() || group == needs_.transaction.groups().front().id);
    if (has_own) {
        std::vector<std::byte> chain;
        for (const crypto::Certificate& each : identity->certificates) {
            chain.insert(chain.end(), each.der().begin(), each.der().end());
        }
        certificates.push_back(ByteString{chain});
    }
    Array<Variant> outputs;
    outputs.push_back(has_own ? node_ids({NodeId{0, certificate_type}}) : node_ids({}));
    outputs.push_back(Variant{std::move(certificates)});
    call.succeed(std::move(outputs));
}

void OwnCertificateMethods::refuse_call(MethodCall& call, const Refusal& refusal)
{
    tell_method(needs_.log, RecordKind::CertificateUpdated, call, refusal.status, &refusal);
    answer_with(call, refusal);
}

bool OwnCertificateMethods::refuses_another(MethodCall& call)
{
    const auto& may_replace = needs_.files.may_replace_own;
    const auto may = may_replace ? may_replace() : Configured<void>{};
    if (!may) {
        call.fail(may.error().status, text(may.error()));
    }
    return !may;
}

} // namespace busbar::administration::detail
