#include <busbar/crypto/signing_request.hpp>

#include <openssl/err.h>

#include "certificate_content.hpp"

namespace busbar::crypto {

namespace {

using Request = std::unique_ptr<X509_REQ, detail::FreeWith<X509_REQ_free>>;

struct FreeExtensions {
    void operator()(STACK_OF(X509_EXTENSION) * extensions) const
    {
        sk_X509_EXTENSION_pop_free(extensions, X509_EXTENSION_free);
    }
};
using Extensions = std::unique_ptr<STACK_OF(X509_EXTENSION), FreeExtensions>;

bool push(STACK_OF(X509_EXTENSION) * extensions, X509_REQ* request, int id,
          const std::string& value)
{
    X509V3_CTX context;
    X509V3_set_ctx(&context, nullptr, nullptr, request, nullptr, 0);
    detail::Extension extension = detail::make_extension(context, id, value);
    if (!extension || sk_X509_EXTENSION_push(extensions, extension.get()) <= 0) {
        return false;
    }
    static_cast<void>(extension.release());
    return true;
}

/// Adds an extensionRequest (RFC 2985, 5.4.2). The CA adds the key identifiers.
bool add_extensions(X509_REQ* request, const std::string& names)
{
    const Extensions extensions{sk_X509_EXTENSION_new_null()};
    return extensions &&
           push(extensions.get(), request, NID_basic_constraints, detail::basic_constraints) &&
           push(extensions.get(), request, NID_key_usage, detail::key_usage) &&
           push(extensions.get(), request, NID_ext_key_usage, detail::extended_key_usage) &&
           push(extensions.get(), request, NID_subject_alt_name, names) &&
           X509_REQ_add_extensions(request, extensions.get()) == 1;
}

bool fill(X509_REQ* request, const PrivateKey& key, const CertificateSubject& subject,
          const std::string& names)
{
    return X509_REQ_set_version(request, X509_REQ_VERSION_1) == 1 &&
           detail::add_fields(X509_REQ_get_subject_name(request), subject) &&
           X509_REQ_set_pubkey(request, key.native()) == 1 && add_extensions(request, names) &&
           X509_REQ_sign(request, key.native(), EVP_sha256()) > 0;
}

} // namespace

Result<std::vector<std::byte>> create_signing_request(const PrivateKey& key,
                                                      const CertificateSubject& subject)
{
    const auto names = detail::alternative_names(subject);
    if (!names) {
        return fail(names.error());
    }
    const Request request{X509_REQ_new()};
    unsigned char* der = nullptr;
    const int size = request && fill(request.get(), key, subject, *names)
                         ? i2d_X509_REQ(request.get(), &der)
                         : -1;
    const detail::DerPointer owned{der};
    ERR_clear_error();
    if (size <= 0) {
        return fail(status::Bad_InvalidArgument);
    }
    const auto bytes = std::as_bytes(std::span{der, static_cast<std::size_t>(size)});
    std::vector<std::byte> result{bytes.begin(), bytes.end()};
    return result;
}

} // namespace busbar::crypto
