#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/secret.hpp>

struct evp_pkey_st;

namespace busbar::crypto {

/// An RSA key pair. Immutable; copies share.
class BUSBAR_API PrivateKey {
public:
    /// Parses PEM or DER of at most 64 KiB, PKCS#1 or PKCS#8, the latter also encrypted.
    /// Bad_ConfigurationError if it is none of these or not an RSA key, if the passphrase is wrong,
    /// or if decrypting would take more than three million iterations. Never prompts for a
    /// passphrase.
    [[nodiscard]] static Result<PrivateKey> parse(std::span<const std::byte> contents,
                                                  std::string_view passphrase = {});
    /// Generates a key of 2048 to 4096 bits; Bad_InvalidArgument for any other size.
    [[nodiscard]] static Result<PrivateKey> generate(std::uint32_t bits);

    /// Returns PKCS#8 PEM without a passphrase, for a file that only its owner may read.
    [[nodiscard]] Result<Secret> to_pem() const;
    /// Writes the PEM to a file that only its owner may read. Failed if the key cannot be written
    /// as PEM.
    [[nodiscard]] Stored<void> save(Storage& storage, std::string_view name) const;
    [[nodiscard]] std::size_t key_size() const;
    /// True if this is the private half of the certificate's key.
    [[nodiscard]] bool belongs_to(const Certificate& certificate) const;

    [[nodiscard]] evp_pkey_st* native() const { return key_.get(); }

private:
    explicit PrivateKey(std::shared_ptr<evp_pkey_st> key) : key_{std::move(key)} {}

    std::shared_ptr<evp_pkey_st> key_;
};

} // namespace busbar::crypto
