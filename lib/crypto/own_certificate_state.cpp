#include "own_certificate_state.hpp"

#include <utility>

#include "openssl.hpp"

namespace busbar::crypto::detail {

namespace {

std::optional<PrivateKey> parse_key(const FileContents& file)
{
    if (!file.bytes) {
        return std::nullopt;
    }
    auto key = PrivateKey::parse(file.bytes->span());
    return key ? std::optional{*std::move(key)} : std::nullopt;
}

bool is_same_key(const PrivateKey& a, const PrivateKey& b)
{
    return EVP_PKEY_eq(a.native(), b.native()) == 1;
}

std::vector<std::byte> der_of(const CertificateChain& certificates)
{
    std::vector<std::byte> der;
    for (const Certificate& certificate : certificates) {
        der.insert(der.end(), certificate.der().begin(), certificate.der().end());
    }
    return der;
}

Stored<void> replace(const OwnCertificateFiles& files, const OwnCertificate& own, bool has_its_key)
{
    if (auto kept = files.keep_aside(); !kept) {
        return kept;
    }
    if (!has_its_key) {
        if (auto saved = files.save_pending_key(own.key); !saved) {
            return saved;
        }
    }
    return files.save_certificate(der_of(own.certificates));
}

} // namespace

OwnCertificateState read_state(const OwnCertificateFiles& files)
{
    const FileContents certificate = files.read_certificate();
    const FileContents key = files.read_key();
    const FileContents pending_key = files.read_pending_key();
    OwnCertificateState state{certificate.exists, key.exists,
                              pending_key.exists, {},
                              parse_key(key),     parse_key(pending_key)};
    if (certificate.bytes) {
        if (auto certificates = read_certificates(certificate.bytes->span())) {
            state.certificates = *std::move(certificates);
        }
    }
    return state;
}

Stored<void> finish_switch(const OwnCertificateFiles& files, OwnCertificateState& state)
{
    state.key = std::exchange(state.pending_key, std::nullopt);
    state.has_key = true;
    // The present key file is the old one, or an operator has put another one there meanwhile.
    auto kept = files.keep_key_aside();
    return kept ? files.promote_pending_key(*state.key) : kept;
}

Checked<OwnCertificateState> prepare(const OwnCertificateFiles& files)
{
    if (!files.create_folders()) {
        return refuse(unwritable(files.certificate()));
    }
    OwnCertificateState state = read_state(files);
    if (state.is_half_switched() && !finish_switch(files, state)) {
        return refuse(unwritable(files.key()));
    }
    return state;
}

Checked<OwnCertificate> put_in_force(const OwnCertificateFiles& files,
                                     const OwnCertificateState& state, OwnCertificate own)
{
    const bool has_its_key = state.key && is_same_key(*state.key, own.key);
    if (!replace(files, own, has_its_key)) {
        return refuse(unwritable(files.certificate()));
    }
    if (!has_its_key) {
        // If this fails, the next call that reads or changes the store does it.
        static_cast<void>(files.promote_pending_key(own.key));
    }
    return own;
}

Checked<void> stage(const OwnCertificateFiles& files, const OwnCertificateState& state,
                    const OwnCertificate& own, FileTransaction& change)
{
    const bool has_its_key = state.key && is_same_key(*state.key, own.key);
    Stored<void> done = files.keep_aside();
    if (done && !has_its_key) {
        done = files.stage_pending_key(own.key, change);
    }
    if (done) {
        done = files.stage_certificate(der_of(own.certificates), change);
    }
    return done ? Checked<void>{} : Checked<void>{refuse(unwritable(files.certificate()))};
}

} // namespace busbar::crypto::detail
