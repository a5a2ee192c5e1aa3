#include "own_certificate_files.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <string_view>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <busbar/crypto/file.hpp>
#include <busbar/crypto/own_certificate.hpp>

#include "descriptor.hpp"
#include "openssl.hpp"

namespace busbar::crypto::detail {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_own_file_size = 131'072;
/// Files of one certificate that differ, in the folder of the replaced ones.
constexpr int max_namesakes = 100;

/// Durable, as files are: what lies in a folder is gone if the folder's own name is.
Result<void> create_folder(const std::string& path, ::mode_t mode)
{
    if (::mkdir(path.c_str(), mode) != 0) {
        return errno == EEXIST ? Result<void>{} : fail(status::Bad_ResourceUnavailable);
    }
    const std::string parent = fs::path{path}.parent_path().string();
    const Descriptor file{
        ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (!file.is_open() || ::fsync(file.get()) != 0) {
        return fail(status::Bad_ResourceUnavailable);
    }
    return {};
}

bool read_all(int file, std::span<std::byte> bytes)
{
    while (!bytes.empty()) {
        const ssize_t size = ::read(file, bytes.data(), bytes.size());
        if (size < 0 && errno == EINTR) {
            continue;
        }
        if (size <= 0) {
            return false;
        }
        bytes = bytes.subspan(static_cast<std::size_t>(size));
    }
    return true;
}

bool is_same(std::span<const std::byte> a, std::span<const std::byte> b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

/// Saves `bytes` under a name that is free, or finds that they lie there already.
Result<void> keep(std::span<const std::byte> bytes, const std::string& stem,
                  std::string_view extension, FileAccess access)
{
    for (int i = 1; i <= max_namesakes; ++i) {
        const std::string number = i == 1 ? "" : "-" + std::to_string(i);
        const std::string path = stem + number + std::string{extension};
        const FileContents there = read_file(path);
        if (!there.exists) {
            return save_file(path, bytes, access);
        }
        if (there.bytes && is_same(there.bytes->span(), bytes)) {
            return {};
        }
    }
    return fail(status::Bad_ResourceUnavailable);
}

/// The thumbprint of a certificate; of anything else, one of the bytes.
std::string name_of(std::span<const std::byte> bytes)
{
    const auto certificates = read_certificates(bytes);
    return certificates ? certificates->front().thumbprint_text() : hexadecimal(sha1_of(bytes));
}

std::string find_stranger(const std::string& folder, std::span<const std::string> known)
{
    std::error_code error;
    for (fs::directory_iterator at{folder, error}; !error && at != fs::directory_iterator{};
         at.increment(error)) {
        std::string path = at->path().string();
        if (std::find(known.begin(), known.end(), path) == known.end() &&
            !is_unfinished_file(at->path().filename().string())) {
            return path;
        }
    }
    return {};
}

} // namespace

OwnCertificateFiles::OwnCertificateFiles(const std::string& folder)
    : own_{(folder.empty() ? "." : folder) + "/own"}, certificate_{own_ + "/certs/own.der"},
      key_{own_ + "/private/own.pem"}, pending_key_{own_ + "/private/pending.pem"}
{
}

std::string OwnCertificateFiles::stranger() const
{
    const std::array known{certificate_, key_, pending_key_};
    std::string path = find_stranger(own_ + "/certs", known);
    return path.empty() ? find_stranger(own_ + "/private", known) : path;
}

Result<void> OwnCertificateFiles::create_folders() const
{
    std::error_code error;
    const fs::path store = fs::path{own_}.parent_path();
    fs::create_directories(store.parent_path(), error);
    for (const auto& [path, mode] : {
             std::pair{store.string(), ::mode_t{0755}},
             std::pair{own_, ::mode_t{0755}},
             std::pair{own_ + "/certs", ::mode_t{0755}},
             std::pair{own_ + "/private", ::mode_t{0700}},
             std::pair{own_ + "/replaced", ::mode_t{0700}},
         }) {
        if (const auto created = create_folder(path, mode); !created) {
            return created;
        }
    }
    // What a process that died was about to write may be a key.
    for (const char* folder : {"/certs", "/private", "/replaced"}) {
        remove_unfinished_files(own_ + folder);
    }
    return {};
}

Result<void> OwnCertificateFiles::keep_aside() const
{
    const FileContents certificate = read_file(certificate_);
    const FileContents key = read_file(key_);
    if ((certificate.exists && !certificate.bytes) || (key.exists && !key.bytes)) {
        return fail(status::Bad_ResourceUnavailable);
    }
    const auto& name_giver = certificate.exists ? certificate : key;
    if (!name_giver.exists) {
        return {};
    }
    const std::string stem = own_ + "/replaced/" + name_of(name_giver.bytes->span());
    if (certificate.exists) {
        const auto kept = keep(certificate.bytes->span(), stem, ".der", FileAccess::Everyone);
        if (!kept) {
            return kept;
        }
    }
    return key.exists ? keep(key.bytes->span(), stem, ".pem", FileAccess::Owner) : Result<void>{};
}

Result<void> OwnCertificateFiles::keep_key_aside() const
{
    const FileContents key = read_file(key_);
    if (!key.exists) {
        return {};
    }
    if (!key.bytes) {
        return fail(status::Bad_ResourceUnavailable);
    }
    const std::string folder = own_ + "/replaced/";
    std::error_code error;
    for (fs::directory_iterator at{folder, error}; !error && at != fs::directory_iterator{};
         at.increment(error)) {
        const FileContents there = read_file(at->path().string());
        if (there.bytes && is_same(there.bytes->span(), key.bytes->span())) {
            return {};
        }
    }
    const std::string stem = folder + hexadecimal(sha1_of(key.bytes->span()));
    return keep(key.bytes->span(), stem, ".pem", FileAccess::Owner);
}

Result<void> OwnCertificateFiles::save_pending_key(const PrivateKey& key) const
{
    return key.save(pending_key_);
}

Result<void> OwnCertificateFiles::save_certificate(std::span<const std::byte> der) const
{
    return save_file(certificate_, der, FileAccess::Everyone);
}

Result<void> OwnCertificateFiles::promote_pending_key(const PrivateKey& key) const
{
    if (const auto saved = key.save(key_); !saved) {
        return saved;
    }
    return remove_file(pending_key_);
}

FileContents read_file(const std::string& path)
{
    struct ::stat facts {};
    if (::stat(path.c_str(), &facts) != 0 && (errno == ENOENT || errno == ENOTDIR)) {
        return {};
    }
    FileContents contents{true, std::nullopt};
    // O_NONBLOCK: whatever lies there, opening it does not wait.
    const Descriptor file{::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
    if (!file.is_open() || ::fstat(file.get(), &facts) != 0 || !S_ISREG(facts.st_mode) ||
        facts.st_size < 0 || static_cast<std::size_t>(facts.st_size) > max_own_file_size) {
        return contents;
    }
    // Of its final size at once: a buffer that grows leaves copies of a key behind.
    Secret bytes{static_cast<std::size_t>(facts.st_size)};
    if (read_all(file.get(), bytes.span())) {
        contents.bytes = std::move(bytes);
    }
    return contents;
}

} // namespace busbar::crypto::detail
