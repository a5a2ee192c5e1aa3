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

/// What lies under a name.
struct FileContents {
    bool exists{false};
    /// None if it is no regular file, longer than 128 KiB or cannot be read.
    std::optional<Secret> bytes;
};

/// The files of an OwnCertificateStore: their names, and the steps in which they change. Each
/// function that writes is durable when it returns.
class OwnCertificateFiles {
public:
    explicit OwnCertificateFiles(Storage& storage) : storage_{&storage} {}

    // Where people find them.

    [[nodiscard]] std::string certificate() const;
    [[nodiscard]] std::string key() const;
    [[nodiscard]] std::string pending_key() const;
    /// Some file that lies beside the certificate or the key and that nothing here reads; empty if
    /// there is none.
    [[nodiscard]] std::string stranger() const;

    [[nodiscard]] FileContents read_certificate() const;
    [[nodiscard]] FileContents read_key() const;
    [[nodiscard]] FileContents read_pending_key() const;

    /// Makes the folders that are missing; those with keys are for their owner alone.
    [[nodiscard]] Stored<void> create_folders() const;
    /// Copies certificate and key, whatever they hold, to the replaced ones.
    [[nodiscard]] Stored<void> keep_aside() const;
    /// The key alone, which belongs to no certificate, unless it lies there already.
    [[nodiscard]] Stored<void> keep_key_aside() const;
    [[nodiscard]] Stored<void> save_pending_key(const PrivateKey& key) const;
    [[nodiscard]] Stored<void> save_certificate(std::span<const std::byte> der) const;
    // The same in a transaction.

    [[nodiscard]] static Stored<void> stage_pending_key(const PrivateKey& key,
                                                        FileTransaction& change);
    [[nodiscard]] static Stored<void> stage_certificate(std::span<const std::byte> der,
                                                        FileTransaction& change);
    /// The pending key is the key from now on.
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
