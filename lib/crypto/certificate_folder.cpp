#include "certificate_folder.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <span>

#include <busbar/crypto/file.hpp>

namespace busbar::crypto::detail {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_entries = 1'000;
constexpr std::uintmax_t max_file_size = 65'536;
constexpr DateTime one_minute{60 * DateTime::ticks_per_second};

/// The regular files of a folder; none if it cannot be read. Nothing here throws: the iterator's
/// operator++ would.
std::vector<fs::directory_entry> files_of(const fs::path& folder)
{
    std::vector<fs::directory_entry> files;
    std::error_code error;
    for (fs::directory_iterator at{folder, error}; !error && at != fs::directory_iterator{};
         at.increment(error)) {
        std::error_code unreadable;
        if (at->is_regular_file(unreadable) && files.size() < max_entries) {
            files.push_back(*at);
        }
    }
    return files;
}

} // namespace

CertificateFolder::Entry CertificateFolder::read(const fs::path& file, std::uintmax_t size,
                                                 fs::file_time_type time) const
{
    const auto known = std::find_if(entries_.begin(), entries_.end(),
                                    [&](const Entry& entry) { return entry.path == file; });
    if (known != entries_.end() && known->size == size && known->time == time) {
        return *known;
    }
    Entry entry{file, size, time, std::nullopt};
    if (size <= max_file_size) {
        std::string contents(static_cast<std::size_t>(size), '\0');
        std::ifstream stream{file, std::ios::binary};
        stream.read(contents.data(), static_cast<std::streamsize>(contents.size()));
        contents.resize(static_cast<std::size_t>(stream.gcount()));
        auto certificate = Certificate::parse_file(std::as_bytes(std::span{contents}));
        if (certificate) {
            entry.certificate = *std::move(certificate);
        }
    }
    return entry;
}

std::vector<Certificate> CertificateFolder::certificates()
{
    std::vector<Entry> entries;
    std::vector<Certificate> result;
    for (const fs::directory_entry& file : files_of(path_)) {
        std::error_code error;
        const std::uintmax_t size = file.file_size(error);
        const fs::file_time_type time = error ? fs::file_time_type{} : file.last_write_time(error);
        if (error) {
            continue;
        }
        entries.push_back(read(file.path(), size, time));
        if (entries.back().certificate) {
            result.push_back(*entries.back().certificate);
        }
    }
    entries_ = std::move(entries);
    return result;
}

bool RejectedFolder::may_write(DateTime now)
{
    if (now < minute_ || now.ticks - minute_.ticks >= one_minute.ticks) {
        minute_ = now;
        written_ = 0;
    }
    return written_ < max_per_minute_;
}

void RejectedFolder::make_room() const
{
    std::vector<fs::directory_entry> files = files_of(path_);
    while (files.size() >= max_files_ && !files.empty()) {
        const auto oldest = std::min_element(
            files.begin(), files.end(), [](const fs::directory_entry& a, const auto& b) {
                std::error_code error;
                return a.last_write_time(error) < b.last_write_time(error);
            });
        std::error_code error;
        fs::remove(oldest->path(), error);
        files.erase(oldest);
    }
}

void RejectedFolder::save(const Certificate& certificate, DateTime now)
{
    // Named by its thumbprint alone: what a certificate says of itself is no file name.
    const fs::path file = path_ / (certificate.thumbprint_text() + ".der");
    std::error_code error;
    if (fs::exists(file, error) || !may_write(now)) {
        return;
    }
    make_room();
    if (save_file(file.string(), certificate.der(), FileAccess::Everyone)) {
        ++written_;
    }
}

} // namespace busbar::crypto::detail
