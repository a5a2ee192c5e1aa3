#pragma once

#include <deque>
#include <vector>

#include <busbar/administration/file_system.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// The folders whose files clients see.
class FileSystems {
public:
    /// Makes the folders that are missing. Throws ConfigError.
    explicit FileSystems(const std::vector<FilesConfig>& files);

    /// They refer to this.
    [[nodiscard]] const std::vector<administration::FileSystem>& all() const { return all_; }

private:
    std::deque<storage::FolderStorage> folders_;
    std::vector<administration::FileSystem> all_;
};

} // namespace busbar::product
