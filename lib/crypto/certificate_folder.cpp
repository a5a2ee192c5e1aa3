#include "certificate_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <span>
#include <utility>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>

#include <busbar/core/text.hpp>
#include <busbar/crypto/file.hpp>

#include "descriptor.hpp"
#include "openssl.hpp"

namespace busbar::crypto::detail {

namespace {

/// The times of files advance in steps of some milliseconds, on some disks of two seconds. A file
/// that was written so shortly ago can be written again without a trace in its state.
constexpr std::int64_t settling_seconds = 3;

constexpr std::string_view unreadable = "cannot be read";
constexpr std::string_view beyond_budget = "is beyond the limit of bytes in a folder";

FileState state_of(const struct stat& facts)
{
    return {facts.st_dev,
            facts.st_ino,
            facts.st_size,
            {facts.st_mtim.tv_sec, facts.st_mtim.tv_nsec},
            {facts.st_ctim.tv_sec, facts.st_ctim.tv_nsec}};
}

bool is_settled(const FileState& state, DateTime now)
{
    return std::max(state.modified, state.changed).seconds < now.unix_seconds() - settling_seconds;
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
            file.problem = "is no revocation list";
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
        file.problem = "is no certificate";
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

CertificateFolder::CertificateFolder(const std::string& store, std::string name,
                                     FolderContents contents, bool may_be_missing)
    : path_{store + "/" + name}, name_{std::move(name)}, contents_{contents}, may_be_missing_{
                                                                                  may_be_missing}
{
}

std::string CertificateFolder::path_of(std::string_view file) const
{
    return path_ + "/" + std::string{file};
}

std::optional<CertificateFolder::Names> CertificateFolder::names(const StoreLimits& limits,
                                                                 int folder) const
{
    Descriptor again{::dup(folder)};
    DIR* stream = again.is_open() ? ::fdopendir(again.get()) : nullptr;
    if (stream == nullptr) {
        return std::nullopt;
    }
    static_cast<void>(again.release());
    Names result;
    while (const dirent* entry = ::readdir(stream)) {
        const std::string_view name{entry->d_name};
        if (name == "." || name == ".." || is_unfinished_file(name)) {
            continue;
        }
        if (result.names.size() == limits.max_files) {
            result.is_cut = true;
            break;
        }
        result.names.emplace_back(name);
    }
    ::closedir(stream);
    std::sort(result.names.begin(), result.names.end());
    return result;
}

const FolderFile* CertificateFolder::known(std::string_view name) const
{
    const auto found =
        std::lower_bound(files_.begin(), files_.end(), name,
                         [](const FolderFile& file, std::string_view n) { return file.name < n; });
    return found != files_.end() && found->name == name ? &*found : nullptr;
}

FolderFile CertificateFolder::read(int folder, const std::string& name, std::size_t max_size) const
{
    FolderFile result{name, {}, {}, {}, {}};
    const Descriptor file{
        ::openat(folder, name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
    struct stat facts = {};
    if (!file.is_open() || ::fstat(file.get(), &facts) != 0 || !S_ISREG(facts.st_mode)) {
        result.problem = unreadable;
        return result;
    }
    result.state = state_of(facts);
    const auto contents = read_rest(file.get(), max_size);
    if (!contents) {
        result.problem = unreadable;
        return result;
    }
    result.digest = digest_of(*contents);
    const FolderFile* before = known(name);
    if (before != nullptr && before->is_usable() && before->digest == result.digest) {
        result.object = before->object;
    } else {
        parse(result, contents_, *contents);
    }
    return result;
}

/// Nothing for folders and for files that have just gone. `budget`: bytes that the files from here
/// on may have together.
std::optional<FolderFile> CertificateFolder::look_at(int folder, const std::string& name,
                                                     const StoreLimits& limits, DateTime now,
                                                     std::size_t& budget) const
{
    struct stat facts = {};
    if (::fstatat(folder, name.c_str(), &facts, AT_SYMLINK_NOFOLLOW) != 0 ||
        S_ISDIR(facts.st_mode)) {
        return std::nullopt;
    }
    const FileState state = state_of(facts);
    const auto size = static_cast<std::size_t>(facts.st_size);
    const std::size_t max_size = kind() == Kind::Certificate ? limits.max_certificate_file_size
                                                             : limits.max_revocation_list_file_size;
    if (!S_ISREG(facts.st_mode)) {
        return FolderFile{name, state, {}, {}, "is no plain file; links are not followed"};
    }
    if (size > max_size) {
        return FolderFile{name, state, {}, {}, "is too large"};
    }
    if (size > budget) {
        return FolderFile{name, state, {}, {}, beyond_budget};
    }
    budget -= size;
    const FolderFile* before = known(name);
    if (before != nullptr && before->state == state && before->problem != beyond_budget &&
        is_settled(state, now)) {
        return *before;
    }
    return read(folder, name, max_size);
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
    const Descriptor folder{::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    const bool is_missing = !folder.is_open() && errno == ENOENT && may_be_missing_;
    const auto found = folder.is_open() ? names(limits, folder.get()) : std::nullopt;
    std::vector<FolderFile> files;
    std::size_t budget = limits.max_folder_size;
    for (const std::string& name : found ? found->names : std::vector<std::string>{}) {
        if (auto file = look_at(folder.get(), name, limits, now, budget)) {
            files.push_back(*std::move(file));
        }
    }
    is_cut_ = found && found->is_cut;
    set_problem(!found && !is_missing ? unreadable
                : is_cut_             ? "has too many files: not all are looked at"
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
