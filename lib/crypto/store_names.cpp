#include "store_names.hpp"

#include <algorithm>
#include <string_view>

#include <busbar/crypto/certificate_store.hpp>

#include "openssl.hpp"

namespace busbar::crypto::detail {

namespace {

constexpr std::size_t max_name_length = 64;

/// Returns the last common name, which is the most specific one; empty if there is none.
std::string common_name(const X509_NAME* name)
{
    int at = -1;
    for (int next = at; (next = X509_NAME_get_index_by_NID(name, NID_commonName, next)) >= 0;) {
        at = next;
    }
    const X509_NAME_ENTRY* entry = at < 0 ? nullptr : X509_NAME_get_entry(name, at);
    unsigned char* text = nullptr;
    const int size =
        entry == nullptr ? -1 : ASN1_STRING_to_UTF8(&text, X509_NAME_ENTRY_get_data(entry));
    std::string result;
    if (size > 0) {
        result.assign(reinterpret_cast<const char*>(text), static_cast<std::size_t>(size));
    }
    OPENSSL_free(text);
    return result;
}

bool is_harmless(char c)
{
    constexpr std::string_view marks = " -_.@";
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           marks.find(c) != std::string_view::npos;
}

std::string file_name(std::string name, const std::string& thumbprint)
{
    name.resize(std::min(name.size(), max_name_length));
    std::replace_if(
        name.begin(), name.end(), [](char c) { return !is_harmless(c); }, '_');
    // A leading dot hides a file.
    name.erase(0, name.find_first_not_of(" ."));
    return (name.empty() ? "" : name + " ") + "[" + thumbprint + "]";
}

} // namespace

std::string store_file_name(const Certificate& certificate)
{
    return file_name(common_name(X509_get_subject_name(certificate.native())),
                     certificate.thumbprint_text());
}

std::string store_file_name(const RevocationList& list)
{
    return file_name(issuer_common_name(list), list.thumbprint_text());
}

std::string issuer_common_name(const RevocationList& list)
{
    return common_name(X509_CRL_get_issuer(list.native()));
}

} // namespace busbar::crypto::detail

namespace busbar::crypto {

std::string file_name_of(const RevocationList& list)
{
    return detail::store_file_name(list) + ".crl";
}

} // namespace busbar::crypto
