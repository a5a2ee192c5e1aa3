#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>

#include "product/configuration/config.hpp"
#include "source_files.hpp"

namespace busbar::product {

/// The last state with which a controller worked completely. The controller keeps a copy, so that
/// it can start even if files are half copied, damaged or gone.
struct TakenOver {
    /// The configuration's file, and the files that it names.
    SourceFiles::Texts files;
    /// Online changes as stored by Settings. If empty, keep the stored ones.
    std::optional<std::string> settings;
    /// The file of the project of model mode; null for none.
    std::shared_ptr<const std::string> project;
    /// The listeners; if empty, keep the stored ones.
    std::vector<FurtherListener> listeners;

    /// Empty for no project.
    [[nodiscard]] std::string project_text() const { return project ? *project : std::string{}; }
};

/// Stores the copy in the folder "taken-over" of a Storage. Replaces each part as a whole, and only
/// if it changed. Not thread-safe.
class TakenOverFiles {
public:
    static constexpr std::string_view folder = "taken-over";

    /// `storage` must outlive this object.
    explicit TakenOverFiles(Storage& storage) : storage_{&storage} {}

    /// Stores the state. Fails with the first problem of the Storage; the previous copy of a part
    /// that could not be stored stays.
    [[nodiscard]] Configured<void> keep(const TakenOver& all);
    /// Removes the settings, because they were dropped on purpose and must not return.
    void forget_settings();
    /// Does the same for one of the files. Fails with a problem of the Storage.
    [[nodiscard]] Configured<void> forget_file(const std::string& path);
    /// Reads the copy; nothing if the controller never ran. A damaged part counts as missing.
    [[nodiscard]] std::optional<TakenOver> read();

    /// Copies a valid file at the root of the Storage; if the file does not exist, removes its
    /// copy. Fails with a problem of the Storage; then it tries to remove the copy as well, because
    /// an old one may contain what was revoked since.
    [[nodiscard]] Configured<void> keep_copy(std::string_view file);
    /// Returns the copy of a file; nothing if it is missing or damaged.
    [[nodiscard]] std::optional<std::string> copy(std::string_view file);

private:
    [[nodiscard]] Configured<void> keep_part(std::string_view name, std::string_view text);
    [[nodiscard]] std::string part(std::string_view name);

    Storage* storage_;
    /// Checksum of each part, as far as known.
    std::map<std::string, std::string, std::less<>> known_;
    /// The project that was stored last, which need not be looked at again.
    std::shared_ptr<const std::string> kept_project_;
};

} // namespace busbar::product
