#include <busbar/crypto/certificate_store.hpp>

#include <openssl/err.h>

#include <busbar/core/text.hpp>

#include "openssl.hpp"

namespace busbar::crypto {

namespace {

using detail::Bio;

std::string contents_of(BIO* bio)
{
    char* text = nullptr;
    const long size = BIO_get_mem_data(bio, &text);
    return size <= 0 ? std::string{} : std::string{text, static_cast<std::size_t>(size)};
}

/// One line; what strangers wrote gets no second one.
std::string line(std::string_view label, std::string_view value)
{
    constexpr std::size_t width = 14;
    constexpr std::size_t max_value = 1'024;
    std::string result{label};
    result += ":";
    result.resize(width, ' ');
    return result + (value.empty() ? "-" : printable(value, max_value)) + "\n";
}

std::string serial_number(const X509* certificate)
{
    const Bio bio{BIO_new(BIO_s_mem())};
    if (!bio || i2a_ASN1_INTEGER(bio.get(), X509_get0_serialNumber(certificate)) <= 0) {
        return {};
    }
    return contents_of(bio.get());
}

std::string extension_text(const X509* certificate, int id)
{
    const int at = X509_get_ext_by_NID(certificate, id, -1);
    X509_EXTENSION* extension = at < 0 ? nullptr : X509_get_ext(certificate, at);
    const Bio bio{BIO_new(BIO_s_mem())};
    if (extension == nullptr || !bio ||
        X509V3_EXT_print(bio.get(), extension, X509V3_EXT_DEFAULT, 0) != 1) {
        ERR_clear_error();
        return {};
    }
    return contents_of(bio.get());
}

std::string name_of_signature(const X509* certificate)
{
    return OBJ_nid2ln(X509_get_signature_nid(certificate));
}

std::string key_text(const Certificate& certificate)
{
    const EVP_PKEY* key = X509_get0_pubkey(certificate.native());
    const char* type = EVP_PKEY_get0_type_name(key);
    return std::string{type == nullptr ? "unknown" : type} + ", " +
           std::to_string(EVP_PKEY_get_bits(key)) + " bits";
}

std::string host_names(const Certificate& certificate)
{
    std::string text;
    for (const std::string& host : certificate.host_names()) {
        text += (text.empty() ? "" : ", ") + host;
    }
    return text;
}

} // namespace

std::string certificate_text(const Certificate& certificate)
{
    const X509* x509 = certificate.native();
    return line("Subject", certificate.subject()) +
           line("Issuer", detail::text_of(X509_get_issuer_name(x509))) +
           line("Serial", serial_number(x509)) +
           line("Valid from", to_string(certificate.valid_from())) +
           line("Valid to", to_string(certificate.valid_to())) +
           line("Application", certificate.application_uri()) +
           line("Hosts", host_names(certificate)) + line("Key", key_text(certificate)) +
           line("Signature", name_of_signature(x509)) +
           line("Usage", extension_text(x509, NID_key_usage)) +
           line("Purpose", extension_text(x509, NID_ext_key_usage)) +
           line("CA", extension_text(x509, NID_basic_constraints)) +
           line("Thumbprint", certificate.thumbprint_text());
}

std::string revocation_list_text(const RevocationList& list)
{
    return line("Issuer", list.issuer()) + line("This update", to_string(list.this_update())) +
           line("Next update",
                list.next_update().is_null() ? std::string{} : to_string(list.next_update())) +
           line("Revoked", std::to_string(list.size())) +
           line("Thumbprint", list.thumbprint_text());
}

} // namespace busbar::crypto
