#include "key_derivation.hpp"

#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/pkcs12.h>

namespace busbar::crypto::detail {

namespace {

using Pbe = std::unique_ptr<PBEPARAM, FreeWith<PBEPARAM_free>>;
using Pbe2 = std::unique_ptr<PBE2PARAM, FreeWith<PBE2PARAM_free>>;
using Pbkdf2 = std::unique_ptr<PBKDF2PARAM, FreeWith<PBKDF2PARAM_free>>;
using EncryptedKey = std::unique_ptr<X509_SIG, FreeWith<X509_SIG_free>>;

/// Maximum number of blocks of a PEM file that are read.
constexpr int max_blocks = 20;

int scheme_of(const X509_ALGOR& algorithm)
{
    return OBJ_obj2nid(algorithm.algorithm);
}

/// Returns the parameters, if they are a SEQUENCE of the expected kind.
template <typename T>
T* unpack(const X509_ALGOR& algorithm, const ASN1_ITEM* item)
{
    return static_cast<T*>(ASN1_TYPE_unpack_sequence(item, algorithm.parameter));
}

std::optional<std::uint64_t> number(const ASN1_INTEGER* integer)
{
    std::uint64_t value = 0;
    if (integer == nullptr || ASN1_INTEGER_get_uint64(&value, integer) != 1 || value == 0) {
        return std::nullopt;
    }
    return value;
}

std::optional<std::uint64_t> iterations_of_pbes2(const X509_ALGOR& algorithm)
{
    const Pbe2 scheme{unpack<PBE2PARAM>(algorithm, ASN1_ITEM_rptr(PBE2PARAM))};
    if (!scheme || scheme->keyfunc == nullptr || scheme_of(*scheme->keyfunc) != NID_id_pbkdf2) {
        return std::nullopt; // scrypt too, whose cost depends on more than one number
    }
    const Pbkdf2 derivation{unpack<PBKDF2PARAM>(*scheme->keyfunc, ASN1_ITEM_rptr(PBKDF2PARAM))};
    return derivation ? number(derivation->iter) : std::nullopt;
}

bool is_affordable(const X509_SIG* key, std::uint64_t limit)
{
    const X509_ALGOR* algorithm = nullptr;
    X509_SIG_get0(key, &algorithm, nullptr);
    const auto iterations = iterations_of(*algorithm);
    return iterations && *iterations <= limit;
}

EncryptedKey parse_encrypted_key(const unsigned char* der, long size)
{
    return EncryptedKey{d2i_X509_SIG(nullptr, &der, size)};
}

/// One block of a PEM file.
struct Block {
    ~Block()
    {
        OPENSSL_free(name);
        OPENSSL_free(header);
        OPENSSL_clear_free(data, static_cast<std::size_t>(size));
    }

    char* name{nullptr};
    char* header{nullptr};
    unsigned char* data{nullptr};
    long size{0};
};

bool are_affordable_blocks(BIO* pem, std::uint64_t limit)
{
    for (int i = 0; i < max_blocks; ++i) {
        Block block;
        if (PEM_read_bio(pem, &block.name, &block.header, &block.data, &block.size) != 1) {
            return true;
        }
        // OpenSSL goes by the contents, whatever the name says.
        const EncryptedKey key = parse_encrypted_key(block.data, block.size);
        if (key && !is_affordable(key.get(), limit)) {
            return false;
        }
    }
    return false;
}

} // namespace

std::optional<std::uint64_t> iterations_of(const X509_ALGOR& algorithm)
{
    const int scheme = scheme_of(algorithm);
    if (scheme == NID_pbes2) {
        return iterations_of_pbes2(algorithm);
    }
    if (EVP_PBE_find(EVP_PBE_TYPE_OUTER, scheme, nullptr, nullptr, nullptr) != 1) {
        return std::nullopt;
    }
    const Pbe parameters{unpack<PBEPARAM>(algorithm, ASN1_ITEM_rptr(PBEPARAM))};
    return parameters ? number(parameters->iter) : std::nullopt;
}

bool is_affordable_key(std::span<const std::byte> contents, std::uint64_t limit)
{
    const EncryptedKey key =
        parse_encrypted_key(bytes_of(contents), static_cast<long>(contents.size()));
    const Bio pem = memory_bio(contents);
    const bool result =
        (!key || is_affordable(key.get(), limit)) && pem && are_affordable_blocks(pem.get(), limit);
    ERR_clear_error();
    return result;
}

} // namespace busbar::crypto::detail
