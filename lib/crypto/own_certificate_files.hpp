#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include <busbar/core/result.hpp>
#include <busbar/crypto/private_key.hpp>
#include <busbar/crypto/secret.hpp>

namespace busbar::crypto::detail {

/// What lies under a name.
struct FileContents {
    bool exists{false};
    /// None if it is no regular file, too long or cannot be read.
    std::optional<Secret> bytes;
};

/// The files of an OwnCertificateStore: their names, and the steps in which they change. Each
/// function that writes is durable when it returns, and Bad_ResourceUnavailable if it fails.
class OwnCertificateFiles {
public:
    explicit OwnCertificateFiles(const std::string& folder);

    [[nodiscard]] const std::string& certificate() const { return certificate_; }
    [[nodiscard]] const std::string& key() const { return key_; }
    [[nodiscard]] const std::string& pending_key() const { return pending_key_; }

    /// Some file that lies beside the certificate or the key and that nothing here reads; empty if
    /// there is none.
    [[nodiscard]] std::string stranger() const;

    /// Makes the folders that are missing; those with keys are for their owner alone.
    [[nodiscard]] Result<void> create_folders() const;
    /// Copies certificate and key, whatever they hold, to the replaced ones.
    [[nodiscard]] Result<void> keep_aside() const;
    /// The key alone, which belongs to no certificate, unless it lies there already.
    [[nodiscard]] Result<void> keep_key_aside() const;
    [[nodiscard]] Result<void> save_pending_key(const PrivateKey& key) const;
    [[nodiscard]] Result<void> save_certificate(std::span<const std::byte> der) const;
    /// The pending key is the key from now on.
    [[nodiscard]] Result<void> promote_pending_key(const PrivateKey& key) const;

private:
    std::string own_;
    std::string certificate_;
    std::string key_;
    std::string pending_key_;
};

/// At most 128 KiB.
[[nodiscard]] FileContents read_file(const std::string& path);

} // namespace busbar::crypto::detail
