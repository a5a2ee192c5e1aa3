#include <busbar/crypto/certificate.hpp>

#include <algorithm>

#include <openssl/core_names.h>
#include <openssl/err.h>
#include <openssl/pem.h>

#include "openssl.hpp"

namespace busbar::crypto {

namespace {

constexpr std::size_t max_certificate_size = 16'384;
// Policies allow 4096 bits at most (Part 7); the time for a signature grows with the square.
constexpr int max_modulus_bits = 8'192;
constexpr int max_exponent_bits = 64;

using Number = std::unique_ptr<BIGNUM, detail::FreeWith<BN_free>>;

Number key_number(const EVP_PKEY* key, const char* name)
{
    BIGNUM* number = nullptr;
    EVP_PKEY_get_bn_param(key, name, &number);
    return Number{number};
}

/// Returns false for RSA keys that are invalid or cost too much: even numbers, an exponent of one
/// or a giant one, a giant modulus. A chain may contain other kinds of keys.
bool is_usable(const EVP_PKEY* key)
{
    if (EVP_PKEY_get_base_id(key) != EVP_PKEY_RSA) {
        return true;
    }
    const Number modulus = key_number(key, OSSL_PKEY_PARAM_RSA_N);
    const Number exponent = key_number(key, OSSL_PKEY_PARAM_RSA_E);
    return modulus && exponent && BN_is_odd(modulus.get()) == 1 && BN_is_odd(exponent.get()) == 1 &&
           BN_is_one(exponent.get()) == 0 && BN_num_bits(exponent.get()) <= max_exponent_bits &&
           BN_num_bits(modulus.get()) <= max_modulus_bits;
}

detail::GeneralNames alternative_names(X509* certificate)
{
    return detail::GeneralNames{static_cast<GENERAL_NAMES*>(
        X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr))};
}

std::string text_of(const ASN1_STRING* text)
{
    return {reinterpret_cast<const char*>(ASN1_STRING_get0_data(text)),
            static_cast<std::size_t>(ASN1_STRING_length(text))};
}

std::string address_text(const ASN1_OCTET_STRING* address)
{
    const auto bytes = text_of(address);
    std::string text;
    if (bytes.size() == 4) {
        for (const char byte : bytes) {
            text += (text.empty() ? "" : ".") + std::to_string(static_cast<unsigned char>(byte));
        }
        return text;
    }
    constexpr std::string_view digits = "0123456789abcdef";
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const auto byte = static_cast<unsigned char>(bytes[i]);
        text += i != 0 && i % 2 == 0 ? ":" : "";
        text += digits[byte >> 4U];
        text += digits[byte & 15U];
    }
    return text;
}

/// Returns the size of the DER element at the start of `der`; 0 if it is unknown or exceeds the
/// bytes.
std::size_t element_size(std::span<const std::byte> der)
{
    const unsigned char* const begin = detail::bytes_of(der);
    const unsigned char* at = begin;
    long size = 0;
    int tag = 0;
    int type = 0;
    const int flags = ASN1_get_object(&at, &size, &tag, &type, static_cast<long>(der.size()));
    ERR_clear_error();
    if ((flags & 0x81) != 0 || size < 0) { // 0x80: an error; 1: a length that comes at the end
        return 0;
    }
    const std::size_t total = static_cast<std::size_t>(at - begin) + static_cast<std::size_t>(size);
    return total <= der.size() ? total : 0;
}

} // namespace

Certificate::Certificate(std::shared_ptr<x509_st> x509, std::vector<std::byte> der)
    : x509_{std::move(x509)}, der_{std::make_shared<const std::vector<std::byte>>(std::move(der))}
{
}

Result<Certificate> Certificate::parse(std::span<const std::byte> der)
{
    const unsigned char* at = detail::bytes_of(der);
    detail::X509Pointer x509{der.empty() || der.size() > max_certificate_size
                                 ? nullptr
                                 : d2i_X509(nullptr, &at, static_cast<long>(der.size()))};
    const EVP_PKEY* key = x509 ? X509_get0_pubkey(x509.get()) : nullptr;
    const bool is_good =
        key != nullptr && at == detail::bytes_of(der) + der.size() && is_usable(key);
    ERR_clear_error();
    if (!is_good) {
        return fail(status::Bad_CertificateInvalid);
    }
    return Certificate{std::shared_ptr<x509_st>{std::move(x509)}, {der.begin(), der.end()}};
}

Result<Certificate> Certificate::parse_file(std::span<const std::byte> contents)
{
    const detail::Bio bio = detail::memory_bio(contents);
    const detail::X509Pointer x509{
        bio ? PEM_read_bio_X509(bio.get(), nullptr, detail::give_no_passphrase, nullptr) : nullptr};
    ERR_clear_error();
    if (!x509) {
        return parse(contents);
    }
    unsigned char* der = nullptr;
    const int size = i2d_X509(x509.get(), &der);
    const detail::DerPointer owned{der};
    if (size <= 0) {
        return fail(status::Bad_CertificateInvalid);
    }
    auto result = parse(std::as_bytes(std::span{der, static_cast<std::size_t>(size)}));
    return result;
}

std::vector<std::byte> Certificate::thumbprint() const
{
    return detail::sha1_of(*der_);
}

std::string Certificate::thumbprint_text() const
{
    return detail::hexadecimal(thumbprint());
}

std::string spelled_thumbprint(std::string_view text)
{
    std::string spelled{text};
    for (char& c : spelled) {
        c = c >= 'a' && c <= 'f' ? static_cast<char>(c - 'a' + 'A') : c;
    }
    return spelled;
}

std::string Certificate::subject() const
{
    return detail::text_of(X509_get_subject_name(x509_.get()));
}

std::vector<std::string> Certificate::uris() const
{
    std::vector<std::string> result;
    const auto names = alternative_names(x509_.get());
    for (int i = 0; i < sk_GENERAL_NAME_num(names.get()); ++i) {
        const GENERAL_NAME* name = sk_GENERAL_NAME_value(names.get(), i);
        if (name->type == GEN_URI) {
            result.push_back(text_of(name->d.uniformResourceIdentifier));
        }
    }
    return result;
}

std::string Certificate::application_uri() const
{
    const auto all = uris();
    return all.empty() ? std::string{} : all.front();
}

bool Certificate::is_of_application(std::string_view uri) const
{
    const auto all = uris();
    return !uri.empty() && std::find(all.begin(), all.end(), uri) != all.end();
}

std::vector<std::string> Certificate::host_names() const
{
    std::vector<std::string> result;
    const auto names = alternative_names(x509_.get());
    for (int i = 0; i < sk_GENERAL_NAME_num(names.get()); ++i) {
        const GENERAL_NAME* name = sk_GENERAL_NAME_value(names.get(), i);
        if (name->type == GEN_DNS) {
            result.push_back(text_of(name->d.dNSName));
        } else if (name->type == GEN_IPADD) {
            result.push_back(address_text(name->d.iPAddress));
        }
    }
    return result;
}

DateTime Certificate::valid_from() const
{
    return detail::date_time_of(X509_get0_notBefore(x509_.get()));
}

DateTime Certificate::valid_to() const
{
    return detail::date_time_of(X509_get0_notAfter(x509_.get()));
}

std::uint32_t Certificate::key_bits() const
{
    const EVP_PKEY* key = X509_get0_pubkey(x509_.get());
    if (EVP_PKEY_get_base_id(key) != EVP_PKEY_RSA) {
        return 0;
    }
    return static_cast<std::uint32_t>(EVP_PKEY_get_bits(key));
}

namespace {

Result<Certificate> find_or_parse(std::span<const std::byte> der,
                                  std::span<const Certificate> known)
{
    const auto same = std::ranges::find_if(known, [&](const Certificate& certificate) {
        return std::ranges::equal(certificate.der(), der);
    });
    return same != known.end() ? *same : Certificate::parse(der);
}

} // namespace

Result<CertificateChain> parse_chain(std::span<const std::byte> der,
                                     std::span<const Certificate> known)
{
    if (der.empty() || der.size() > max_chain_size) {
        return fail(status::Bad_CertificateInvalid);
    }
    CertificateChain chain;
    while (!der.empty()) {
        const std::size_t size = element_size(der);
        if (size == 0 || chain.size() == max_chain_length) {
            return fail(status::Bad_CertificateInvalid);
        }
        auto certificate = find_or_parse(der.first(size), known);
        if (!certificate) {
            return fail(certificate.error());
        }
        chain.push_back(*std::move(certificate));
        der = der.subspan(size);
    }
    return chain;
}

void KnownCertificates::keep(const CertificateChain& chain)
{
    certificates_.reserve(max_count);
    for (const Certificate& certificate : chain) {
        if (certificate.der().size() > max_size) {
            continue;
        }
        const auto same = std::ranges::find(certificates_, certificate);
        if (same != certificates_.end()) {
            std::rotate(same, same + 1, certificates_.end());
            continue;
        }
        if (certificates_.size() == max_count) {
            certificates_.erase(certificates_.begin());
        }
        certificates_.push_back(certificate);
    }
}

} // namespace busbar::crypto
