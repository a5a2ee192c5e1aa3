#include <busbar/crypto/certificate_store.hpp>

#include <algorithm>
#include <array>
#include <span>
#include <sstream>

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

/// Returns one line; text from others cannot add a second one.
std::string line(std::string_view label, std::string_view value)
{
    constexpr std::size_t width = 14;
    constexpr std::size_t max_value = 4'096;
    std::string result{label};
    result += ":";
    result.resize(width, ' ');
    return result + (value.empty() ? "-" : printable(value, max_value)) + "\n";
}

std::string integer_text(const ASN1_INTEGER* number)
{
    const Bio bio{BIO_new(BIO_s_mem())};
    if (!bio || i2a_ASN1_INTEGER(bio.get(), number) <= 0) {
        return {};
    }
    return contents_of(bio.get());
}

/// OpenSSL breaks the text of an extension into lines.
std::string in_one_line(const std::string& text)
{
    std::string result;
    std::istringstream lines{text};
    for (std::string each; std::getline(lines, each);) {
        const std::size_t from = each.find_first_not_of(' ');
        const std::size_t to = each.find_last_not_of(' ');
        if (from != std::string::npos) {
            result += (result.empty() ? "" : ", ") + each.substr(from, to - from + 1);
        }
    }
    return result;
}

/// Unknown extensions are shown in hexadecimal.
std::string value_of(X509_EXTENSION* extension)
{
    const Bio bio{BIO_new(BIO_s_mem())};
    if (!bio || X509V3_EXT_print(bio.get(), extension, X509V3_EXT_DEFAULT, 0) != 1) {
        ERR_clear_error();
        const ASN1_OCTET_STRING* value = X509_EXTENSION_get_data(extension);
        return detail::hexadecimal(std::as_bytes(std::span{
            ASN1_STRING_get0_data(value), static_cast<std::size_t>(ASN1_STRING_length(value))}));
    }
    return in_one_line(contents_of(bio.get()));
}

std::string extension_text(const X509* certificate, int id)
{
    const int at = X509_get_ext_by_NID(certificate, id, -1);
    X509_EXTENSION* extension = at < 0 ? nullptr : X509_get_ext(certificate, at);
    return extension == nullptr ? std::string{} : value_of(extension);
}

std::string name_of(const X509_EXTENSION* extension)
{
    constexpr std::size_t max_name = 80;
    std::array<char, max_name> name{};
    OBJ_obj2txt(name.data(), name.size(),
                X509_EXTENSION_get_object(const_cast<X509_EXTENSION*>(extension)), 0);
    const bool is_critical = X509_EXTENSION_get_critical(extension) != 0;
    return std::string{name.data()} + (is_critical ? " (critical)" : "");
}

/// Returns a line for each extension that has none of its own.
std::string extension_lines(const STACK_OF(X509_EXTENSION) * extensions)
{
    std::string text;
    for (int i = 0; i < sk_X509_EXTENSION_num(extensions); ++i) {
        X509_EXTENSION* extension = sk_X509_EXTENSION_value(extensions, i);
        const int id = OBJ_obj2nid(X509_EXTENSION_get_object(extension));
        if (id == NID_key_usage || id == NID_ext_key_usage || id == NID_basic_constraints) {
            continue;
        }
        text += line("Extension", name_of(extension) + ": " + value_of(extension));
    }
    return text;
}

std::string key_type(const EVP_PKEY* key)
{
    const char* type = EVP_PKEY_get0_type_name(key);
    return std::string{type == nullptr ? "unknown" : type} + ", " +
           std::to_string(EVP_PKEY_get_bits(key)) + " bits";
}

/// Returns the key itself, as in the certificate, in groups of eight bytes between which a line may
/// break.
std::string key_bytes(const X509* certificate)
{
    constexpr std::size_t group = 8;
    const ASN1_BIT_STRING* key = X509_get0_pubkey_bitstr(certificate);
    auto left = std::as_bytes(
        std::span{ASN1_STRING_get0_data(key), static_cast<std::size_t>(ASN1_STRING_length(key))});
    std::string text;
    while (!left.empty()) {
        const auto next = left.first(std::min(group, left.size()));
        text += (text.empty() ? "" : " ") + detail::hexadecimal(next);
        left = left.subspan(next.size());
    }
    return text;
}

/// Lists the revoked certificates with the time of revocation.
std::string revoked_lines(const X509_CRL* list)
{
    constexpr int max_shown = 1'000;
    const STACK_OF(X509_REVOKED)* all = X509_CRL_get_REVOKED(const_cast<X509_CRL*>(list));
    const int count = std::max(sk_X509_REVOKED_num(all), 0);
    std::string text;
    for (int i = 0; i < std::min(count, max_shown); ++i) {
        const X509_REVOKED* revoked = sk_X509_REVOKED_value(all, i);
        text +=
            line("Serial",
                 integer_text(X509_REVOKED_get0_serialNumber(revoked)) + " since " +
                     to_string(detail::date_time_of(X509_REVOKED_get0_revocationDate(revoked))));
    }
    return count <= max_shown ? text
                              : text + line("Serial", std::to_string(count - max_shown) + " more");
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
           line("Version", std::to_string(X509_get_version(x509) + 1)) +
           line("Serial", integer_text(X509_get0_serialNumber(x509))) +
           line("Valid from", to_string(certificate.valid_from())) +
           line("Valid to", to_string(certificate.valid_to())) +
           line("Application", certificate.application_uri()) +
           line("Hosts", host_names(certificate)) + line("Key", key_type(X509_get0_pubkey(x509))) +
           line("Public key", key_bytes(x509)) +
           line("Signature", OBJ_nid2ln(X509_get_signature_nid(x509))) +
           line("Usage", extension_text(x509, NID_key_usage)) +
           line("Purpose", extension_text(x509, NID_ext_key_usage)) +
           line("CA", extension_text(x509, NID_basic_constraints)) +
           extension_lines(X509_get0_extensions(x509)) +
           line("Thumbprint", certificate.thumbprint_text());
}

std::string revocation_list_text(const RevocationList& list)
{
    const X509_CRL* crl = list.native();
    return line("Issuer", list.issuer()) +
           line("Version", std::to_string(X509_CRL_get_version(crl) + 1)) +
           line("Signature", OBJ_nid2ln(X509_CRL_get_signature_nid(crl))) +
           line("This update", to_string(list.this_update())) +
           line("Next update",
                list.next_update().is_null() ? std::string{} : to_string(list.next_update())) +
           line("Revoked", std::to_string(list.size())) + revoked_lines(crl) +
           extension_lines(X509_CRL_get0_extensions(crl)) +
           line("Thumbprint", list.thumbprint_text());
}

} // namespace busbar::crypto
