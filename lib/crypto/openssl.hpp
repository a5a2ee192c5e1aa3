#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <busbar/core/date_time.hpp>

/// Owners for OpenSSL's objects and casts to its bytes.
namespace busbar::crypto::detail {

template <auto Free>
struct FreeWith {
    template <typename T>
    void operator()(T* object) const
    {
        Free(object);
    }
};

/// Owns the result of an i2d function: `owned{der}`, right after it, frees it whatever is thrown.
struct FreeDer {
    void operator()(unsigned char* der) const { OPENSSL_free(der); }
};
using DerPointer = std::unique_ptr<unsigned char, FreeDer>;
using Bio = std::unique_ptr<BIO, FreeWith<BIO_free_all>>;
using Pkey = std::unique_ptr<EVP_PKEY, FreeWith<EVP_PKEY_free>>;
using PkeyContext = std::unique_ptr<EVP_PKEY_CTX, FreeWith<EVP_PKEY_CTX_free>>;
using DigestContext = std::unique_ptr<EVP_MD_CTX, FreeWith<EVP_MD_CTX_free>>;
using CipherContext = std::unique_ptr<EVP_CIPHER_CTX, FreeWith<EVP_CIPHER_CTX_free>>;
using Mac = std::unique_ptr<EVP_MAC, FreeWith<EVP_MAC_free>>;
using MacContext = std::unique_ptr<EVP_MAC_CTX, FreeWith<EVP_MAC_CTX_free>>;
using X509Pointer = std::unique_ptr<X509, FreeWith<X509_free>>;
using CrlPointer = std::unique_ptr<X509_CRL, FreeWith<X509_CRL_free>>;
using Algorithm = std::unique_ptr<X509_ALGOR, FreeWith<X509_ALGOR_free>>;
using GeneralNames = std::unique_ptr<GENERAL_NAMES, FreeWith<GENERAL_NAMES_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, FreeWith<X509_EXTENSION_free>>;

inline const unsigned char* bytes_of(std::span<const std::byte> bytes)
{
    return reinterpret_cast<const unsigned char*>(bytes.data());
}

inline unsigned char* bytes_of(std::span<std::byte> bytes)
{
    return reinterpret_cast<unsigned char*>(bytes.data());
}

template <std::size_t Size>
unsigned char* bytes_of(std::span<std::byte, Size> bytes)
{
    return reinterpret_cast<unsigned char*>(bytes.data());
}

/// Returns a read-only BIO for the bytes.
Bio memory_bio(std::span<const std::byte> bytes);

/// For PEM_read_*: prevents OpenSSL from asking a terminal for a passphrase.
int give_no_passphrase(char*, int, int, void*);

/// Returns null for a missing or unreadable time.
DateTime date_time_of(const ASN1_TIME* time);
/// Sets `time` in seconds: a UTCTime from 1950 to 2049, else a GeneralizedTime (RFC 5280, 4.1.2.5).
bool set_time(ASN1_TIME* to, DateTime time);
/// Returns "CN=Name, O=..." for people; everything except printable ASCII is escaped.
std::string text_of(const X509_NAME* name);
/// Returns whether the algorithm beside the signature equals the signed one (RFC 5280, 5.1.1.2).
/// X509_verify checks that for certificates, X509_CRL_verify not up to OpenSSL 3.0.19. `der` is the
/// encoding of `list`.
bool names_one_algorithm(const X509_CRL* list, std::span<const std::byte> der);
/// A thumbprint (Part 6, 6.7.2.3).
std::vector<std::byte> sha1_of(std::span<const std::byte> bytes);
/// Returns upper-case hexadecimal.
std::string hexadecimal(std::span<const std::byte> bytes);

} // namespace busbar::crypto::detail
