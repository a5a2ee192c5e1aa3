#pragma once

#include <deque>
#include <vector>

#include <busbar/administration/file_system.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// The folders whose files clients can see.
class FileSystems {
public:
    /// Creates missing folders. Throws ConfigError.
    explicit FileSystems(const std::vector<FilesConfig>& files);

    /// The FileSystems refer to this object.
    [[nodiscard]] const std::vector<administration::FileSystem>& all() const { return all_; }

private:
    std::deque<storage::FolderStorage> folders_;
    std::vector<administration::FileSystem> all_;
};

} // namespace busbar::product
