#include "certificate_folder.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include <busbar/core/text.hpp>

#include "openssl.hpp"

namespace busbar::crypto::detail {

namespace {

/// File times advance in steps of some milliseconds, on some disks of two seconds. A file that was
/// written less than this ago can be written again without a change of its times.
constexpr std::int64_t settling_seconds = 3;

constexpr std::string_view unreadable = "cannot be read";
constexpr std::string_view beyond_budget = "is beyond the limit of bytes in a folder";

bool is_settled(const StorageEntry& entry, DateTime now)
{
    return entry.touched.unix_seconds() < now.unix_seconds() - settling_seconds;
}

std::array<std::byte, 32> digest_of(std::span<const std::byte> bytes)
{
    std::array<std::byte, 32> digest{};
    EVP_Digest(bytes.data(), bytes.size(), bytes_of(std::span<std::byte>{digest}), nullptr,
               EVP_sha256(), nullptr);
    return digest;
}

void parse(FolderFile& file, FolderContents kind, std::span<const std::byte> contents)
{
    if (kind == FolderContents::RevocationLists) {
        if (auto list = RevocationList::parse_file(contents)) {
            file.object = *std::move(list);
        } else {
            file.problem = "is not a revocation list";
        }
        return;
    }
    auto certificate = Certificate::parse_file(contents);
    if (kind == FolderContents::Chains && !certificate) {
        if (const auto chain = parse_chain(contents)) {
            certificate = chain->front();
        }
    }
    if (!certificate) {
        file.problem = "is not a certificate";
    } else if (kind == FolderContents::Certificates && holds_several_certificates(contents)) {
        file.problem = "holds several certificates; each needs a file of its own";
    } else {
        file.object = *std::move(certificate);
    }
}

} // namespace

bool holds_several_certificates(std::span<const std::byte> contents)
{
    constexpr std::string_view mark = "-----BEGIN CERTIFICATE-----";
    const std::string_view text{reinterpret_cast<const char*>(contents.data()), contents.size()};
    const std::size_t first = text.find(mark);
    return first != std::string_view::npos &&
           text.find(mark, first + mark.size()) != std::string_view::npos;
}

std::string FolderFile::thumbprint() const
{
    if (const Certificate* found = certificate()) {
        return found->thumbprint_text();
    }
    const RevocationList* list = revocation_list();
    return list == nullptr ? std::string{} : list->thumbprint_text();
}

CertificateFolder::CertificateFolder(Storage& storage, std::string name, FolderContents contents,
                                     bool may_be_missing)
    : storage_{&storage}, name_{std::move(name)}, contents_{contents}, may_be_missing_{
                                                                           may_be_missing}
{
}

const FolderFile* CertificateFolder::known(std::string_view name) const
{
    const auto found =
        std::lower_bound(files_.begin(), files_.end(), name,
                         [](const FolderFile& file, std::string_view n) { return file.name < n; });
    return found != files_.end() && found->name == name ? &*found : nullptr;
}

bool CertificateFolder::may_hold(std::string_view file) const
{
    const FolderFile* const found = known(file);
    return found != nullptr ? found->problem == unreadable || found->problem == beyond_budget
                            : is_cut_ || problem_ == unreadable;
}

FolderFile CertificateFolder::read(const StorageEntry& entry, std::size_t max_size) const
{
    FolderFile result{entry.name, entry.modified, entry.version, {}, {}, {}};
    const auto contents = read_file(*storage_, path_of(entry.name), max_size);
    if (!contents) {
        result.problem = unreadable;
        return result;
    }
    result.digest = digest_of(*contents);
    const FolderFile* before = known(entry.name);
    if (before != nullptr && before->is_usable() && before->digest == result.digest) {
        result.object = before->object;
    } else {
        parse(result, contents_, *contents);
    }
    return result;
}

/// Returns nothing for folders. `budget` is the number of bytes that the files from here on may
/// have together.
std::optional<FolderFile> CertificateFolder::look_at(const StorageEntry& entry,
                                                     const StoreLimits& limits, DateTime now,
                                                     std::size_t& budget) const
{
    if (entry.kind == StorageEntry::Kind::Folder) {
        return std::nullopt;
    }
    const auto useless = [&](std::string_view why) {
        return FolderFile{entry.name, entry.modified, entry.version, {}, {}, why};
    };
    const std::size_t max_size = kind() == Kind::Certificate ? limits.max_certificate_file_size
                                                             : limits.max_revocation_list_file_size;
    if (entry.kind != StorageEntry::Kind::File) {
        return useless("is not a regular file; links are not followed");
    }
    if (entry.size > max_size) {
        return useless("is too large");
    }
    if (entry.size > budget) {
        return useless(beyond_budget);
    }
    budget -= static_cast<std::size_t>(entry.size);
    const FolderFile* before = known(entry.name);
    if (before != nullptr && before->version == entry.version && before->problem != beyond_budget &&
        is_settled(entry, now)) {
        return *before;
    }
    return read(entry, max_size);
}

void CertificateFolder::tell(LogSink& log, std::string_view problem, std::string_view file) const
{
    const std::string path = file.empty() ? name_ : name_ + "/" + std::string{file};
    log.write(LogLevel::Warning, "certificate store", printable(path) + " " + std::string{problem});
}

void CertificateFolder::tell_changes(const std::vector<FolderFile>& files, LogSink& log) const
{
    for (const FolderFile& file : files) {
        const FolderFile* before = known(file.name);
        if (!file.problem.empty() && (before == nullptr || before->problem != file.problem ||
                                      before->digest != file.digest)) {
            tell(log, file.problem, file.name);
        }
    }
}

void CertificateFolder::set_problem(std::string_view problem, LogSink& log)
{
    if (!problem.empty() && problem != problem_) {
        tell(log, problem);
    }
    problem_ = problem;
}

bool CertificateFolder::refresh(const StoreLimits& limits, DateTime now, LogSink& log)
{
    const auto found = storage_->list(name_, limits.max_files);
    const bool is_missing =
        !found && may_be_missing_ &&
        (found.error() == StorageError::NotFound || found.error() == StorageError::Away);
    std::vector<FolderFile> files;
    std::size_t budget = limits.max_folder_size;
    if (found) {
        for (const StorageEntry& entry : found->entries) {
            if (auto file = look_at(entry, limits, now, budget)) {
                files.push_back(*std::move(file));
            }
        }
    }
    is_cut_ = found && found->is_cut;
    set_problem(!found && !is_missing ? unreadable
                : is_cut_             ? "has too many files: not all are read"
                                      : "",
                log);
    tell_changes(files, log);
    const bool is_changed =
        !std::equal(files.begin(), files.end(), files_.begin(), files_.end(),
                    [](const FolderFile& a, const FolderFile& b) {
                        return a.name == b.name && a.digest == b.digest && a.problem == b.problem;
                    });
    files_ = std::move(files);
    return is_changed;
}

} // namespace busbar::crypto::detail
