#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <busbar/crypto/certificate.hpp>

namespace busbar::crypto::detail {

/// The certificates among a folder's files, as they are now. A file is read again only when its
/// size or time changed.
class CertificateFolder {
public:
    explicit CertificateFolder(std::filesystem::path path) : path_{std::move(path)} {}

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::vector<Certificate> certificates();

private:
    struct Entry {
        std::filesystem::path path;
        std::uintmax_t size{0};
        std::filesystem::file_time_type time;
        std::optional<Certificate> certificate; // none: the file holds something else
    };

    [[nodiscard]] Entry read(const std::filesystem::path& file, std::uintmax_t size,
                             std::filesystem::file_time_type time) const;

    std::filesystem::path path_;
    std::vector<Entry> entries_;
};

/// Certificates that were refused, for the operator to look at. Strangers fill this folder: it
/// holds at most max_files, the oldest goes first, and max_per_minute are written.
class RejectedFolder {
public:
    RejectedFolder(std::filesystem::path path, std::size_t max_files, std::size_t max_per_minute)
        : path_{std::move(path)}, max_files_{max_files}, max_per_minute_{max_per_minute}
    {
    }

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    void save(const Certificate& certificate, DateTime now);

private:
    [[nodiscard]] bool may_write(DateTime now);
    void make_room() const;

    std::filesystem::path path_;
    std::size_t max_files_;
    std::size_t max_per_minute_;
    DateTime minute_;
    std::size_t written_{0}; // since minute_
};

} // namespace busbar::crypto::detail
