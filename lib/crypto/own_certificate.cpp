#include <busbar/crypto/own_certificate.hpp>

#include <utility>

#include <busbar/core/record.hpp>
#include <busbar/core/text.hpp>
#include <busbar/crypto/signing_request.hpp>

#include "certificate_order.hpp"
#include "own_certificate_state.hpp"

namespace busbar::crypto {

namespace {

using detail::own_certificate_refusal;
using Files = detail::OwnCertificateFiles;
using State = detail::OwnCertificateState;

constexpr std::int64_t ticks_per_day = 86'400 * DateTime::ticks_per_second;

Checked<OwnCertificate> make(const Files& files, const State& state, const PrivateKey& key,
                             const OwnCertificateSettings& settings, DateTime now)
{
    CertificateSubject subject = settings.subject;
    subject.valid_from = DateTime{now.ticks - ticks_per_day};
    subject.valid_days = settings.subject.valid_days == 0 ? 0 : settings.subject.valid_days + 1;
    auto certificate = create_self_signed(key, subject);
    if (!certificate) {
        return refuse(own_certificate_refusal(
            certificate.error(),
            "the settings have a name, address or time that cannot be used in a "
            "certificate",
            "Check the subject's fields, host names, addresses and the clock"));
    }
    return detail::put_in_force(files, state, {{*std::move(certificate)}, key});
}

Checked<PrivateKey> generate(std::uint32_t bits)
{
    auto key = PrivateKey::generate(bits);
    if (!key) {
        return refuse(own_certificate_refusal(key.error(),
                                              "a key of " + std::to_string(bits) +
                                                  " bits cannot be made, expected 2048 to 4096",
                                              "Check the settings"));
    }
    return *std::move(key);
}

} // namespace

OwnCertificateStore::OwnCertificateStore(Storage& storage, LogSink* log)
    : storage_{&storage}, log_{log}
{
}

/// Reports success only; the caller, who gets the refusal, reports failures.
Checked<OwnCertificate> OwnCertificateStore::told(Checked<OwnCertificate> own,
                                                  std::string_view what) const
{
    if (!own || log_ == nullptr) {
        return own;
    }
    const Certificate& certificate = own->certificates.front();
    Record record{RecordKind::CertificateUpdated, LogLevel::Info, "certificate"};
    record.text = "own certificate " + printable(certificate.subject()) + ", " +
                  certificate.thumbprint_text() + ": " + std::string{what} + ", valid until " +
                  to_string(certificate.valid_to());
    record.certificate = certificate.der();
    tell(*log_, record);
    return own;
}

Checked<std::optional<OwnCertificate>>
OwnCertificateStore::load(std::string_view application_uri) const
{
    const Files files{*storage_};
    State state = detail::read_state(files);
    if (!state.has_certificate && !state.has_key) {
        const std::string stranger = files.stranger();
        if (stranger.empty()) {
            return std::nullopt;
        }
        return refuse(detail::broken("found " + printable(stranger) + ", expected " +
                                     files.certificate() + " and " + files.key()));
    }
    if (state.is_half_switched()) {
        // On a disk that cannot be written the pending key is used instead.
        static_cast<void>(detail::finish_switch(files, state));
    }
    if (auto refused = detail::check_files(files, state)) {
        return refuse(*std::move(refused));
    }
    if (auto refused = detail::check_certificates(state.certificates, application_uri)) {
        return refuse(*std::move(refused));
    }
    return OwnCertificate{std::move(state.certificates), *std::move(state.key)};
}

Checked<OwnCertificate> OwnCertificateStore::load_or_create(const OwnCertificateSettings& settings,
                                                            DateTime now) const
{
    auto found = load(settings.subject.application_uri);
    if (!found) {
        return refuse(std::move(found).error());
    }
    if (*found) {
        return **std::move(found);
    }
    const Files files{*storage_};
    auto state = detail::prepare(files);
    if (!state) {
        return refuse(std::move(state).error());
    }
    if (state->has_pending_key && !state->pending_key) {
        return refuse(detail::broken(files.pending_key() + " cannot be read, expected an RSA key"));
    }
    // A request may be pending for it, whose certificate shall still be accepted later.
    auto key = state->pending_key ? *state->pending_key : generate(settings.key_bits);
    return key ? told(make(files, *state, *key, settings, now), "made")
               : refuse(std::move(key).error());
}

Checked<OwnCertificate> OwnCertificateStore::regenerate(const OwnCertificateSettings& settings,
                                                        DateTime now) const
{
    const Files files{*storage_};
    const auto state = detail::prepare(files);
    if (!state) {
        return refuse(state.error());
    }
    const auto key = generate(settings.key_bits);
    return key ? told(make(files, *state, *key, settings, now), "created again")
               : refuse(key.error());
}

Checked<std::vector<std::byte>>
OwnCertificateStore::create_signing_request(const OwnCertificateSettings& settings,
                                            RequestKey which) const
{
    auto made = make_signing_request(settings, which);
    if (!made) {
        return refuse(std::move(made).error());
    }
    if (made->new_key) {
        if (auto kept = keep_request_key(*made->new_key); !kept) {
            return refuse(std::move(kept).error());
        }
    }
    return std::move(made->request);
}

Checked<SigningRequest>
OwnCertificateStore::make_signing_request(const OwnCertificateSettings& settings,
                                          RequestKey which) const
{
    const Files files{*storage_};
    const auto state = detail::prepare(files);
    if (!state) {
        return refuse(state.error());
    }
    if (which == RequestKey::Present && !state->key) {
        return refuse(detail::broken(files.key() + " is missing or cannot be read"));
    }
    const auto key = which == RequestKey::Present ? Checked<PrivateKey>{*state->key}
                                                  : generate(settings.key_bits);
    if (!key) {
        return refuse(key.error());
    }
    auto request = crypto::create_signing_request(*key, settings.subject);
    if (!request) {
        return refuse(own_certificate_refusal(
            request.error(),
            "the settings have a name or address that cannot be used in a certificate",
            "Check the subject's fields, host names and addresses"));
    }
    return SigningRequest{*std::move(request),
                          which == RequestKey::New ? std::optional{*key} : std::nullopt};
}

Checked<void> OwnCertificateStore::keep_request_key(const PrivateKey& key) const
{
    const Files files{*storage_};
    return files.save_pending_key(key)
               ? Checked<void>{}
               : Checked<void>{refuse(detail::unwritable(files.pending_key()))};
}

Checked<OwnCertificate> OwnCertificateStore::take_in(std::span<const std::byte> certificates,
                                                     std::string_view application_uri) const
{
    auto own = match(certificates, application_uri);
    if (!own) {
        return own;
    }
    const Files files{*storage_};
    return told(detail::put_in_force(files, detail::read_state(files), *std::move(own)),
                "issued and put in force");
}

Checked<OwnCertificate> OwnCertificateStore::match(std::span<const std::byte> certificates,
                                                   std::string_view application_uri) const
{
    const auto parsed = read_certificates(certificates);
    if (!parsed) {
        return refuse(parsed.error());
    }
    const auto state = detail::prepare(Files{*storage_});
    if (!state) {
        return refuse(state.error());
    }
    for (const auto& key : {state->pending_key, state->key}) {
        CertificateChain chain = key ? detail::chain_of(*key, *parsed) : CertificateChain{};
        if (chain.empty()) {
            continue;
        }
        if (auto refused = detail::check_certificates(chain, application_uri)) {
            return refuse(*std::move(refused));
        }
        return OwnCertificate{std::move(chain), *key};
    }
    return refuse(
        own_certificate_refusal(parsed->front(), status::Bad_CertificateInvalid,
                                "it belongs neither to the pending key nor to the present one",
                                "Have it issued for the last request, or install it with its key"));
}

Checked<void> OwnCertificateStore::stage(const OwnCertificate& own,
                                         std::string_view application_uri,
                                         FileTransaction& change) const
{
    const CertificateChain chain = detail::chain_of(own.key, own.certificates);
    if (chain.empty()) {
        return refuse(own_certificate_refusal(status::Bad_CertificateInvalid,
                                              "no certificate belongs to the private key",
                                              "Export the key together with its certificate"));
    }
    if (auto refused = detail::check_certificates(chain, application_uri)) {
        return refuse(*std::move(refused));
    }
    const Files files{*storage_};
    const auto state = detail::prepare(files);
    if (!state) {
        return refuse(state.error());
    }
    return detail::stage(files, *state, {chain, own.key}, change);
}

Checked<OwnCertificate> OwnCertificateStore::install(const OwnCertificate& own,
                                                     std::string_view application_uri) const
{
    CertificateChain chain = detail::chain_of(own.key, own.certificates);
    if (chain.empty()) {
        return refuse(own_certificate_refusal(status::Bad_CertificateInvalid,
                                              "no certificate belongs to the private key",
                                              "Export the key together with its certificate"));
    }
    if (auto refused = detail::check_certificates(chain, application_uri)) {
        return refuse(*std::move(refused));
    }
    const Files files{*storage_};
    const auto state = detail::prepare(files);
    return state
               ? told(detail::put_in_force(files, *state, {std::move(chain), own.key}), "installed")
               : refuse(state.error());
}

} // namespace busbar::crypto
