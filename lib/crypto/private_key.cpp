#include <busbar/crypto/private_key.hpp>

#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>

#include <algorithm>

#include "key_derivation.hpp"
#include "openssl.hpp"

namespace busbar::crypto {

namespace {

constexpr std::size_t max_key_file_size = 65'536;
/// For an encrypted key: some seconds.
constexpr std::uint64_t max_iterations = 3'000'000;

/// Returns the passphrase, or none: OpenSSL must never ask a terminal for it.
int give_passphrase(char* buffer, int size, int, void* user)
{
    const auto& passphrase = *static_cast<const std::string_view*>(user);
    if (passphrase.size() > static_cast<std::size_t>(size)) {
        return -1;
    }
    std::copy(passphrase.begin(), passphrase.end(), buffer);
    return static_cast<int>(passphrase.size());
}

/// Tries each form, from the first byte again.
detail::Pkey read_key(std::span<const std::byte> contents, std::string_view passphrase)
{
    detail::Bio bio = detail::memory_bio(contents);
    detail::Pkey key{bio ? PEM_read_bio_PrivateKey(bio.get(), nullptr, give_passphrase, &passphrase)
                         : nullptr};
    if (!key) {
        bio = detail::memory_bio(contents);
        key.reset(bio ? d2i_PrivateKey_bio(bio.get(), nullptr) : nullptr);
    }
    if (!key) {
        bio = detail::memory_bio(contents);
        key.reset(bio ? d2i_PKCS8PrivateKey_bio(bio.get(), nullptr, give_passphrase, &passphrase)
                      : nullptr);
    }
    ERR_clear_error();
    return key;
}

} // namespace

Result<PrivateKey> PrivateKey::parse(std::span<const std::byte> contents,
                                     std::string_view passphrase)
{
    if (contents.size() > max_key_file_size ||
        !detail::is_affordable_key(contents, max_iterations)) {
        return fail(status::Bad_ConfigurationError);
    }
    detail::Pkey key = read_key(contents, passphrase);
    if (!key || EVP_PKEY_get_base_id(key.get()) != EVP_PKEY_RSA) {
        return fail(status::Bad_ConfigurationError);
    }
    return PrivateKey{std::shared_ptr<evp_pkey_st>{std::move(key)}};
}

Result<PrivateKey> PrivateKey::generate(std::uint32_t bits)
{
    if (bits < 2048 || bits > 4096) {
        return fail(status::Bad_InvalidArgument);
    }
    detail::Pkey key{EVP_RSA_gen(bits)};
    if (!key) {
        return fail(status::Bad_ResourceUnavailable);
    }
    return PrivateKey{std::shared_ptr<evp_pkey_st>{std::move(key)}};
}

Result<Secret> PrivateKey::to_pem() const
{
    const detail::Bio bio{BIO_new(BIO_s_secmem())};
    if (!bio || PEM_write_bio_PrivateKey(bio.get(), key_.get(), nullptr, nullptr, 0, nullptr,
                                         nullptr) != 1) {
        return fail(status::Bad_ResourceUnavailable);
    }
    char* text = nullptr;
    const long size = BIO_get_mem_data(bio.get(), &text);
    return Secret{std::string_view{text, static_cast<std::size_t>(size)}};
}

Stored<void> PrivateKey::save(Storage& storage, std::string_view name) const
{
    const auto pem = to_pem();
    return pem ? storage.replace(name, pem->span(), FileAccess::Owner)
               : Stored<void>{not_stored(StorageError::Failed)};
}

std::size_t PrivateKey::key_size() const
{
    return static_cast<std::size_t>(EVP_PKEY_get_size(key_.get()));
}

bool PrivateKey::belongs_to(const Certificate& certificate) const
{
    const bool matches = X509_check_private_key(certificate.native(), key_.get()) == 1;
    ERR_clear_error();
    return matches;
}

} // namespace busbar::crypto
