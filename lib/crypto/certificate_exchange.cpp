#include <busbar/crypto/own_certificate.hpp>

#include <openssl/err.h>
#include <openssl/pem.h>

#include "openssl.hpp"

namespace busbar::crypto {

namespace {

Refusal unreadable(std::string found)
{
    return {status::Bad_CertificateInvalid, "reading certificates", std::move(found), "RFC 5280",
            "Export them again, as PEM or DER"};
}

Result<Certificate> copy_of(X509* x509)
{
    unsigned char* der = nullptr;
    const int size = i2d_X509(x509, &der);
    const detail::DerPointer owned{der};
    if (size <= 0) {
        return fail(status::Bad_CertificateInvalid);
    }
    auto certificate =
        Certificate::parse(std::as_bytes(std::span{der, static_cast<std::size_t>(size)}));
    return certificate;
}

/// Reads certificates; other blocks, such as keys, are skipped.
Checked<std::vector<Certificate>> read_pem(BIO* pem)
{
    std::vector<Certificate> certificates;
    while (const detail::X509Pointer x509{
        PEM_read_bio_X509(pem, nullptr, detail::give_no_passphrase, nullptr)}) {
        auto certificate = copy_of(x509.get());
        if (!certificate) {
            return refuse(unreadable("one of them is damaged or has a key that makes no sense"));
        }
        if (certificates.size() == max_chain_length) {
            return refuse(unreadable("they are too many"));
        }
        certificates.push_back(*std::move(certificate));
    }
    return certificates;
}

Checked<std::vector<Certificate>> read(std::span<const std::byte> contents)
{
    const detail::Bio pem = detail::memory_bio(contents);
    if (contents.size() > 2 * max_chain_size || !pem) {
        return refuse(unreadable("they are too long"));
    }
    auto certificates = read_pem(pem.get());
    if (!certificates || !certificates->empty()) {
        return certificates;
    }
    auto chain = parse_chain(contents);
    return chain ? Checked<std::vector<Certificate>>{*std::move(chain)}
                 : refuse(unreadable("neither PEM nor DER certificates"));
}

} // namespace

Checked<std::vector<Certificate>> read_certificates(std::span<const std::byte> contents)
{
    auto result = read(contents);
    ERR_clear_error();
    return result;
}

} // namespace busbar::crypto
