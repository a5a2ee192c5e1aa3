#include "issuing.hpp"

#include <cstdlib>
#include <map>

#include <openssl/core_names.h>
#include <openssl/param_build.h>
#include <openssl/pem.h>

#include "crypto/openssl.hpp"
#include "support/kept_key.hpp"

namespace busbar::test {

namespace {

using crypto::detail::Bio;
using crypto::detail::Extension;
using crypto::detail::Pkey;
using crypto::detail::X509Pointer;

void add(X509* certificate, X509* issuer, int id, const std::string& value)
{
    if (value.empty()) {
        return;
    }
    X509V3_CTX context;
    X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
    const Extension extension{X509V3_EXT_conf_nid(nullptr, &context, id, value.c_str())};
    if (!extension || X509_add_ext(certificate, extension.get(), -1) != 1) {
        std::abort();
    }
}

void add_unknown(X509* certificate, const std::string& value)
{
    if (value.empty()) {
        return;
    }
    ASN1_OBJECT* object = OBJ_txt2obj("1.2.3.4", 1);
    ASN1_OCTET_STRING* data = ASN1_OCTET_STRING_new();
    ASN1_OCTET_STRING_set(data, reinterpret_cast<const unsigned char*>(value.data()),
                          static_cast<int>(value.size()));
    const Extension extension{X509_EXTENSION_create_by_OBJ(nullptr, object, 1, data)};
    X509_add_ext(certificate, extension.get(), -1);
    ASN1_OCTET_STRING_free(data);
    ASN1_OBJECT_free(object);
}

std::vector<std::byte> der_of(X509* certificate)
{
    const Bio bio{BIO_new(BIO_s_mem())};
    i2d_X509_bio(bio.get(), certificate);
    return contents_of(bio.get());
}

X509Pointer unsigned_certificate(const CertificateOptions& options, EVP_PKEY* key)
{
    static long serial = 1'000;
    X509Pointer x509{X509_new()};
    X509_set_version(x509.get(), options.version);
    ASN1_INTEGER_set(X509_get_serialNumber(x509.get()),
                     options.serial != 0 ? options.serial : ++serial);
    crypto::detail::set_time(X509_getm_notBefore(x509.get()), options.valid_from);
    crypto::detail::set_time(X509_getm_notAfter(x509.get()), options.valid_to);
    X509_NAME_add_entry_by_txt(X509_get_subject_name(x509.get()), "CN", MBSTRING_UTF8,
                               reinterpret_cast<const unsigned char*>(options.common_name.data()),
                               static_cast<int>(options.common_name.size()), -1, 0);
    X509_set_pubkey(x509.get(), key);
    return x509;
}

Pkey public_key(const std::string& modulus, const std::string& exponent)
{
    BIGNUM* n = nullptr;
    BIGNUM* e = nullptr;
    BN_hex2bn(&n, modulus.c_str());
    BN_hex2bn(&e, exponent.c_str());
    OSSL_PARAM_BLD* build = OSSL_PARAM_BLD_new();
    OSSL_PARAM_BLD_push_BN(build, OSSL_PKEY_PARAM_RSA_N, n);
    OSSL_PARAM_BLD_push_BN(build, OSSL_PKEY_PARAM_RSA_E, e);
    OSSL_PARAM* parameters = OSSL_PARAM_BLD_to_param(build);
    const crypto::detail::PkeyContext context{EVP_PKEY_CTX_new_from_name(nullptr, "RSA", nullptr)};
    EVP_PKEY* key = nullptr;
    EVP_PKEY_fromdata_init(context.get());
    EVP_PKEY_fromdata(context.get(), &key, EVP_PKEY_PUBLIC_KEY, parameters);
    OSSL_PARAM_free(parameters);
    OSSL_PARAM_BLD_free(build);
    BN_free(n);
    BN_free(e);
    return Pkey{key};
}

} // namespace

CertificateOptions authority(const std::string& name)
{
    CertificateOptions options;
    options.common_name = name;
    options.names.clear();
    options.basic_constraints = "critical,CA:TRUE";
    options.key_usage = "critical,keyCertSign,cRLSign";
    options.extended_key_usage.clear();
    return options;
}

const crypto::PrivateKey& key_number(std::size_t number, std::uint32_t bits)
{
    static std::map<std::pair<std::size_t, std::uint32_t>, crypto::PrivateKey> keys;
    auto found = keys.find({number, bits});
    if (found == keys.end()) {
        found = keys.emplace(std::pair{number, bits},
                             kept_key("number-" + std::to_string(number), bits))
                    .first;
    }
    return found->second;
}

Issued issue(const CertificateOptions& options, const crypto::PrivateKey& key, const Issued* issuer)
{
    const X509Pointer x509 = unsigned_certificate(options, key.native());
    X509* const by = issuer == nullptr ? x509.get() : issuer->certificate.native();
    X509_set_issuer_name(x509.get(), X509_get_subject_name(by));
    add(x509.get(), by, NID_subject_key_identifier, options.key_identifiers ? "hash" : "");
    add(x509.get(), by, NID_authority_key_identifier, options.key_identifiers ? "keyid" : "");
    add(x509.get(), by, NID_basic_constraints, options.basic_constraints);
    add(x509.get(), by, NID_key_usage, options.key_usage);
    add(x509.get(), by, NID_ext_key_usage, options.extended_key_usage);
    add(x509.get(), by, NID_subject_alt_name, options.names);
    add(x509.get(), by, NID_name_constraints, options.name_constraints);
    add_unknown(x509.get(), options.extra);
    X509_sign(x509.get(), issuer == nullptr ? key.native() : issuer->key.native(),
              EVP_get_digestbyname(options.digest));
    return {*crypto::Certificate::parse(der_of(x509.get())), key};
}

std::vector<std::byte> der_with_public_key(const std::string& modulus, const std::string& exponent)
{
    const Pkey key = public_key(modulus, exponent);
    const X509Pointer x509 = unsigned_certificate({}, key.get());
    X509_set_issuer_name(x509.get(), X509_get_subject_name(x509.get()));
    X509_sign(x509.get(), key_number(0).native(), EVP_sha256());
    return der_of(x509.get());
}

std::string random_modulus(int bits, bool is_odd)
{
    BIGNUM* number = BN_new();
    BN_rand(number, bits, BN_RAND_TOP_ONE, is_odd ? BN_RAND_BOTTOM_ODD : BN_RAND_BOTTOM_ANY);
    if (!is_odd) {
        BN_clear_bit(number, 0);
    }
    char* text = BN_bn2hex(number);
    std::string result{text};
    OPENSSL_free(text);
    BN_free(number);
    return result;
}

std::vector<std::byte> encrypted_key(const crypto::PrivateKey& key, const std::string& passphrase,
                                     bool as_pem)
{
    const Bio bio{BIO_new(BIO_s_mem())};
    const auto write = as_pem ? PEM_write_bio_PKCS8PrivateKey : i2d_PKCS8PrivateKey_bio;
    write(bio.get(), key.native(), EVP_aes_256_cbc(), passphrase.data(),
          static_cast<int>(passphrase.size()), nullptr, nullptr);
    return contents_of(bio.get());
}

std::vector<std::byte> plain_der_key(const crypto::PrivateKey& key)
{
    const Bio bio{BIO_new(BIO_s_mem())};
    i2d_PrivateKey_bio(bio.get(), key.native());
    return contents_of(bio.get());
}

std::vector<std::byte> contents_of(BIO* bio)
{
    char* text = nullptr;
    const long size = BIO_get_mem_data(bio, &text);
    const auto bytes = std::as_bytes(std::span{text, static_cast<std::size_t>(size)});
    return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> pem_of(const crypto::Certificate& certificate)
{
    const Bio bio{BIO_new(BIO_s_mem())};
    PEM_write_bio_X509(bio.get(), certificate.native());
    return contents_of(bio.get());
}

} // namespace busbar::test
