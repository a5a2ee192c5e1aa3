#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/file_transaction.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/crypto/private_key.hpp>
#include <busbar/crypto/secret.hpp>

namespace busbar::crypto::detail {

/// The contents of a file.
struct FileContents {
    bool exists{false};
    /// Empty if it is not a regular file, is longer than 128 KiB or cannot be read.
    std::optional<Secret> bytes;
};

/// The files of an OwnCertificateStore: their names, and the steps in which they change. Each
/// function that writes is durable when it returns.
class OwnCertificateFiles {
public:
    explicit OwnCertificateFiles(Storage& storage) : storage_{&storage} {}

    // The places where people find the files.

    [[nodiscard]] std::string certificate() const;
    [[nodiscard]] std::string key() const;
    [[nodiscard]] std::string pending_key() const;
    /// Returns a file beside the certificate or the key that this class never reads; empty if there
    /// is none.
    [[nodiscard]] std::string stranger() const;

    [[nodiscard]] FileContents read_certificate() const;
    [[nodiscard]] FileContents read_key() const;
    [[nodiscard]] FileContents read_pending_key() const;

    /// Creates missing folders; only the owner may read those with keys.
    [[nodiscard]] Stored<void> create_folders() const;
    /// Copies certificate and key, whatever they contain, to the replaced ones.
    [[nodiscard]] Stored<void> keep_aside() const;
    /// Copies only the key, which belongs to no certificate, unless that was done already.
    [[nodiscard]] Stored<void> keep_key_aside() const;
    [[nodiscard]] Stored<void> save_pending_key(const PrivateKey& key) const;
    [[nodiscard]] Stored<void> save_certificate(std::span<const std::byte> der) const;
    // The same in a transaction.

    [[nodiscard]] static Stored<void> stage_pending_key(const PrivateKey& key,
                                                        FileTransaction& change);
    [[nodiscard]] static Stored<void> stage_certificate(std::span<const std::byte> der,
                                                        FileTransaction& change);
    /// Makes the pending key the key in force.
    [[nodiscard]] Stored<void> promote_pending_key(const PrivateKey& key) const;

private:
    [[nodiscard]] FileContents read(std::string_view name) const;
    [[nodiscard]] Stored<void> keep(std::span<const std::byte> bytes, const std::string& stem,
                                    std::string_view extension, FileAccess access) const;
    [[nodiscard]] std::string find_stranger(std::string_view folder,
                                            std::span<const std::string_view> known) const;

    Storage* storage_;
};

} // namespace busbar::crypto::detail
