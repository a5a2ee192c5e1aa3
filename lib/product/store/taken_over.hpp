#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>

#include "product/configuration/config.hpp"
#include "source_files.hpp"

namespace busbar::product {

/// What a controller ran with when all of it worked last. It keeps a copy of its own, so that it
/// starts whatever has become of the files since: half copied, damaged or gone.
struct TakenOver {
    /// The configuration's file, and those that it names.
    SourceFiles::Texts files;
    /// What administrators had changed, as Settings keeps it. Nothing: what was kept before.
    std::optional<std::string> settings;
    /// The project of model mode, as its file has it; empty: none.
    std::string project;
    /// Where it listened; empty: what was kept before.
    std::vector<FurtherListener> listeners;
};

/// The copy, in the folder "taken-over" of a Storage. Each part is replaced as a whole, and only if
/// it is another one than before. Not thread-safe.
class TakenOverFiles {
public:
    static constexpr std::string_view folder = "taken-over";

    /// `storage` must outlive it.
    explicit TakenOverFiles(Storage& storage) : storage_{&storage} {}

    /// The problem is one of the Storage; what was kept before stays then.
    [[nodiscard]] Configured<void> keep(const TakenOver& all);
    /// Settings that were dropped on purpose do not come back.
    void forget_settings();
    /// As forget_settings(), of one of the files. The problem is one of the Storage.
    [[nodiscard]] Configured<void> forget_file(const std::string& path);
    /// Nothing if the controller never ran. A part that is damaged counts as one that is not there.
    [[nodiscard]] std::optional<TakenOver> read();

    /// Keeps a copy of a file at the root of the Storage, which could be read, as it is now; of
    /// none, there is no copy from now on. The problem is one of the Storage; then there is no copy
    /// either, where that can be had: an old one may have what was taken back since.
    [[nodiscard]] Configured<void> keep_copy(std::string_view file);
    /// Nothing if there is none, or it is damaged.
    [[nodiscard]] std::optional<std::string> copy(std::string_view file);

private:
    [[nodiscard]] Configured<void> keep_part(std::string_view name, std::string text);
    [[nodiscard]] std::string part(std::string_view name);

    Storage* storage_;
    /// What each part has now, as far as that is known.
    std::map<std::string, std::uint32_t, std::less<>> known_;
};

} // namespace busbar::product
