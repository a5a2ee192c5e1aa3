#include "own_certificate_state.hpp"

#include <utility>

#include <busbar/core/text.hpp>

namespace busbar::crypto::detail {

namespace {

constexpr std::uint32_t min_key_bits = 2'048;
constexpr std::uint32_t max_key_bits = 4'096;

} // namespace

Refusal own_certificate_refusal(StatusCode status, std::string found, std::string remedy)
{
    return {status, "own certificate check", std::move(found), "Part 6, 6.2.2", std::move(remedy)};
}

Refusal own_certificate_refusal(const Certificate& certificate, StatusCode status,
                                std::string found, std::string remedy)
{
    Refusal result = own_certificate_refusal(status, std::move(found), std::move(remedy));
    result.subject = printable(certificate.subject());
    result.thumbprint = certificate.thumbprint_text();
    return result;
}

Refusal broken(std::string found)
{
    return own_certificate_refusal(status::Bad_ConfigurationError, std::move(found),
                                   "Put certificate and key back, or have a new certificate made");
}

Refusal unwritable(const std::string& file)
{
    return own_certificate_refusal(
        status::Bad_ResourceUnavailable,
        file + " or a folder beside it cannot be written or copied",
        "Check the disk and its write permissions; the present certificate remains in force");
}

std::optional<Refusal> check_certificates(const CertificateChain& chain,
                                          std::string_view application_uri)
{
    const Certificate& leaf = chain.front();
    if (leaf.key_bits() < min_key_bits || leaf.key_bits() > max_key_bits) {
        return own_certificate_refusal(leaf, status::Bad_CertificatePolicyCheckFailed,
                                       "it has a key of " + std::to_string(leaf.key_bits()) +
                                           " RSA bits, expected 2048 to 4096",
                                       "Have it issued for another key");
    }
    if (!application_uri.empty() && !leaf.is_of_application(application_uri)) {
        return own_certificate_refusal(
            leaf, status::Bad_CertificateUriInvalid,
            "it names \"" + printable(leaf.application_uri()) +
                "\", expected the ApplicationUri \"" + printable(application_uri) + "\"",
            "Have it issued for this ApplicationUri, or configure that of the "
            "certificate");
    }
    std::size_t size = 0;
    for (const Certificate& certificate : chain) {
        size += certificate.der().size();
    }
    if (size > max_chain_size || chain.size() > max_chain_length) {
        return own_certificate_refusal(leaf, status::Bad_CertificateInvalid,
                                       "it and those that signed it are too many or too long",
                                       "Leave the issuers out");
    }
    return std::nullopt;
}

std::optional<Refusal> check_files(const OwnCertificateFiles& files,
                                   const OwnCertificateState& state)
{
    if (!state.has_certificate) {
        return broken("there is a key, " + files.key() + ", but not its certificate, " +
                      files.certificate());
    }
    if (state.certificates.empty()) {
        return broken(files.certificate() + " cannot be read, expected DER or PEM");
    }
    if (!state.has_key) {
        return broken("there is a certificate, " + files.certificate() + ", but not its key, " +
                      files.key());
    }
    if (!state.key) {
        return broken(files.key() + " cannot be read, expected an RSA key without passphrase");
    }
    if (!state.key->belongs_to(state.certificates.front())) {
        return broken("the key in " + files.key() + " is not that of the certificate in " +
                      files.certificate());
    }
    return std::nullopt;
}

} // namespace busbar::crypto::detail
