#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/certificate_store.hpp>
#include <busbar/crypto/revocation_list.hpp>
#include <busbar/crypto/store_limits.hpp>

namespace busbar::crypto::detail {

/// True for PEM with more than one certificate: it is unknown which of them an administrator means.
[[nodiscard]] bool holds_several_certificates(std::span<const std::byte> contents);

/// One file of a folder.
struct FolderFile {
    std::string name;
    DateTime modified{};
    StorageEntry::Version version{};
    std::array<std::byte, 32> digest{}; // of the contents
    std::variant<std::monostate, Certificate, RevocationList> object{};
    std::string_view problem{}; // the reason why there is no object

    /// Returns null if the file holds something else.
    [[nodiscard]] const Certificate* certificate() const { return std::get_if<1>(&object); }
    [[nodiscard]] const RevocationList* revocation_list() const { return std::get_if<2>(&object); }
    [[nodiscard]] bool is_usable() const { return object.index() != 0; }
    [[nodiscard]] std::string thumbprint() const;
};

/// The kind of files in a folder. For a chain, which is concatenated DER (Part 6, 6.2.6), the leaf
/// counts.
enum class FolderContents : std::uint8_t { Certificates, Chains, RevocationLists };

/// The certificates or the revocation lists in one folder, as they are now. Does not follow links
/// or block on pipes, and reads a file only when it has changed.
class CertificateFolder {
public:
    using Kind = StoreEntry::Kind;

    /// Uses the folder `name` of the storage. A missing folder is reported unless `may_be_missing`.
    CertificateFolder(Storage& storage, std::string name, FolderContents contents,
                      bool may_be_missing);

    /// Reads the folder again; true if something changed. Problems are logged once.
    bool refresh(const StoreLimits& limits, DateTime now, LogSink& log);

    [[nodiscard]] const std::vector<FolderFile>& files() const { return files_; }
    [[nodiscard]] Kind kind() const
    {
        return contents_ == FolderContents::RevocationLists ? Kind::RevocationList
                                                            : Kind::Certificate;
    }
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] std::string path_of(std::string_view file) const
    {
        return storage_path(name_, file);
    }
    /// True if the folder has more names than were read.
    [[nodiscard]] bool is_cut() const { return is_cut_; }
    /// True if the file may exist unread: it or the folder cannot be read, or the folder is cut.
    [[nodiscard]] bool may_hold(std::string_view file) const;

private:
    [[nodiscard]] std::optional<FolderFile> look_at(const StorageEntry& entry,
                                                    const StoreLimits& limits, DateTime now,
                                                    std::size_t& budget) const;
    [[nodiscard]] FolderFile read(const StorageEntry& entry, std::size_t max_size) const;
    [[nodiscard]] const FolderFile* known(std::string_view name) const;
    void tell(LogSink& log, std::string_view problem, std::string_view file = {}) const;
    void tell_changes(const std::vector<FolderFile>& files, LogSink& log) const;
    /// Sets the problem of the folder as a whole.
    void set_problem(std::string_view problem, LogSink& log);

    Storage* storage_;
    std::string name_;
    FolderContents contents_;
    bool may_be_missing_;
    bool is_cut_{false};
    std::string_view problem_;
    std::vector<FolderFile> files_;
};

} // namespace busbar::crypto::detail
