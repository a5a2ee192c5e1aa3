#include "certificate_content.hpp"

#include <algorithm>
#include <array>

namespace busbar::crypto::detail {

namespace {

/// Commas, colons and line ends have a meaning in OpenSSL's extension texts.
bool is_plain(std::string_view text, std::string_view also = "")
{
    return std::all_of(text.begin(), text.end(), [&](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '.' || c == '-' || c == '_' || also.find(c) != std::string_view::npos;
    });
}

bool add_field(X509_NAME* name, int id, const std::string& text)
{
    return text.empty() ||
           X509_NAME_add_entry_by_NID(name, id, MBSTRING_UTF8,
                                      reinterpret_cast<const unsigned char*>(text.data()),
                                      static_cast<int>(text.size()), -1, 0) == 1;
}

} // namespace

Result<std::string> alternative_names(const CertificateSubject& subject)
{
    constexpr std::string_view uri_characters = ":/#?=&%+~@!$'()*;";
    if (subject.application_uri.empty() || !is_plain(subject.application_uri, uri_characters)) {
        return fail(status::Bad_InvalidArgument);
    }
    std::string text = "URI:" + subject.application_uri;
    for (const std::string& name : subject.dns_names) {
        if (!is_plain(name)) {
            return fail(status::Bad_InvalidArgument);
        }
        text += ",DNS:" + name;
    }
    for (const std::string& address : subject.ip_addresses) {
        if (!is_plain(address, ":")) {
            return fail(status::Bad_InvalidArgument);
        }
        text += ",IP:" + address;
    }
    return text;
}

bool add_fields(X509_NAME* name, const CertificateSubject& subject)
{
    struct Field {
        int id;
        const std::string& text;
    };
    const std::array fields = {
        Field{NID_commonName, subject.common_name},
        Field{NID_organizationName, subject.organization},
        Field{NID_organizationalUnitName, subject.organizational_unit},
        Field{NID_localityName, subject.locality},
        Field{NID_stateOrProvinceName, subject.state},
        Field{NID_countryName, subject.country},
        Field{NID_domainComponent, subject.domain_component},
    };
    return !subject.common_name.empty() &&
           std::all_of(fields.begin(), fields.end(),
                       [&](const Field& field) { return add_field(name, field.id, field.text); });
}

Extension make_extension(X509V3_CTX& context, int id, const std::string& value)
{
    return Extension{X509V3_EXT_conf_nid(nullptr, &context, id, value.c_str())};
}

} // namespace busbar::crypto::detail
