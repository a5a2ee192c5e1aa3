#include "own_certificate_files.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <busbar/crypto/own_certificate.hpp>

#include "openssl.hpp"

namespace busbar::crypto::detail {

namespace {

constexpr std::string_view certificate_name = "own/certs/own.der";
constexpr std::string_view key_name = "own/private/own.pem";
constexpr std::string_view pending_name = "own/private/pending.pem";
constexpr std::string_view replaced_folder = "own/replaced";

constexpr std::size_t max_own_file_size = 131'072;
/// Maximum number of different files for one certificate in the folder of replaced ones.
constexpr int max_namesakes = 100;
constexpr std::size_t max_replaced = 100'000;

bool is_same(std::span<const std::byte> a, std::span<const std::byte> b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

/// Returns the thumbprint of a certificate; for other contents, that of the bytes.
std::string name_of(std::span<const std::byte> bytes)
{
    const auto certificates = read_certificates(bytes);
    return certificates ? certificates->front().thumbprint_text() : hexadecimal(sha1_of(bytes));
}

} // namespace

std::string OwnCertificateFiles::certificate() const
{
    return storage_->place(certificate_name);
}

std::string OwnCertificateFiles::key() const
{
    return storage_->place(key_name);
}

std::string OwnCertificateFiles::pending_key() const
{
    return storage_->place(pending_name);
}

std::string OwnCertificateFiles::find_stranger(std::string_view folder,
                                               std::span<const std::string_view> known) const
{
    const auto found = storage_->list(folder, known.size() + 1);
    if (found) {
        for (const StorageEntry& entry : found->entries) {
            const std::string path = storage_path(folder, entry.name);
            if (std::find(known.begin(), known.end(), path) == known.end()) {
                return storage_->place(path);
            }
        }
    }
    return {};
}

std::string OwnCertificateFiles::stranger() const
{
    constexpr std::array known{certificate_name, key_name, pending_name};
    std::string path = find_stranger("own/certs", known);
    return path.empty() ? find_stranger("own/private", known) : path;
}

FileContents OwnCertificateFiles::read(std::string_view name) const
{
    // Allocate the final size at once: a growing buffer leaves copies of a key behind.
    Secret buffer{max_own_file_size + 1};
    const auto count = storage_->read(name, 0, buffer.span());
    if (!count &&
        (count.error() == StorageError::NotFound || count.error() == StorageError::Away)) {
        return {};
    }
    if (!count || *count > max_own_file_size) {
        return {true, std::nullopt};
    }
    const std::span<const std::byte> bytes{buffer.span().first(*count)};
    return {true, Secret{bytes}};
}

FileContents OwnCertificateFiles::read_certificate() const
{
    return read(certificate_name);
}

FileContents OwnCertificateFiles::read_key() const
{
    return read(key_name);
}

FileContents OwnCertificateFiles::read_pending_key() const
{
    return read(pending_name);
}

Stored<void> OwnCertificateFiles::create_folders() const
{
    for (const auto& [name, access] : {
             std::pair<std::string_view, FileAccess>{"own/certs", FileAccess::Everyone},
             std::pair<std::string_view, FileAccess>{"own/private", FileAccess::Owner},
             std::pair<std::string_view, FileAccess>{replaced_folder, FileAccess::Owner},
         }) {
        if (auto made = storage_->make_folder(name, access); !made) {
            return made;
        }
        // A file that an interrupted process was writing may contain a key.
        storage_->remove_unfinished(name);
    }
    return {};
}

/// Saves `bytes` under an unused name, or finds that they are saved already.
Stored<void> OwnCertificateFiles::keep(std::span<const std::byte> bytes, const std::string& stem,
                                       std::string_view extension, FileAccess access) const
{
    for (int i = 1; i <= max_namesakes; ++i) {
        const std::string number = i == 1 ? "" : "-" + std::to_string(i);
        const std::string name = stem + number + std::string{extension};
        const FileContents there = read(name);
        if (!there.exists) {
            return storage_->replace(name, bytes, access);
        }
        if (there.bytes && is_same(there.bytes->span(), bytes)) {
            return {};
        }
    }
    return not_stored(StorageError::Failed);
}

Stored<void> OwnCertificateFiles::keep_aside() const
{
    const FileContents certificate = read_certificate();
    const FileContents key = read_key();
    if ((certificate.exists && !certificate.bytes) || (key.exists && !key.bytes)) {
        return not_stored(StorageError::Failed);
    }
    const auto& name_giver = certificate.exists ? certificate : key;
    if (!name_giver.exists) {
        return {};
    }
    const std::string stem = storage_path(replaced_folder, name_of(name_giver.bytes->span()));
    if (certificate.exists) {
        auto kept = keep(certificate.bytes->span(), stem, ".der", FileAccess::Everyone);
        if (!kept) {
            return kept;
        }
    }
    return key.exists ? keep(key.bytes->span(), stem, ".pem", FileAccess::Owner) : Stored<void>{};
}

Stored<void> OwnCertificateFiles::keep_key_aside() const
{
    const FileContents key = read_key();
    if (!key.exists) {
        return {};
    }
    if (!key.bytes) {
        return not_stored(StorageError::Failed);
    }
    const auto replaced = storage_->list(replaced_folder, max_replaced);
    if (replaced) {
        for (const StorageEntry& entry : replaced->entries) {
            const FileContents there = read(storage_path(replaced_folder, entry.name));
            if (there.bytes && is_same(there.bytes->span(), key.bytes->span())) {
                return {};
            }
        }
    }
    const std::string stem = storage_path(replaced_folder, hexadecimal(sha1_of(key.bytes->span())));
    return keep(key.bytes->span(), stem, ".pem", FileAccess::Owner);
}

Stored<void> OwnCertificateFiles::save_pending_key(const PrivateKey& key) const
{
    return key.save(*storage_, pending_name);
}

Stored<void> OwnCertificateFiles::save_certificate(std::span<const std::byte> der) const
{
    return storage_->replace(certificate_name, der, FileAccess::Everyone);
}

Stored<void> OwnCertificateFiles::stage_pending_key(const PrivateKey& key, FileTransaction& change)
{
    const auto pem = key.to_pem();
    return pem ? change.replace(pending_name, pem->span(), FileAccess::Owner)
               : not_stored(StorageError::Failed);
}

Stored<void> OwnCertificateFiles::stage_certificate(std::span<const std::byte> der,
                                                    FileTransaction& change)
{
    return change.replace(certificate_name, der, FileAccess::Everyone);
}

Stored<void> OwnCertificateFiles::promote_pending_key(const PrivateKey& key) const
{
    if (auto saved = key.save(*storage_, key_name); !saved) {
        return saved;
    }
    return storage_->remove(pending_name);
}

} // namespace busbar::crypto::detail
