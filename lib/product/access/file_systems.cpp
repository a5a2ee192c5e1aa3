#include "file_systems.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/types/ids.hpp>

namespace busbar::product {

namespace {

std::vector<NodeId> nodes_named(const std::vector<std::string>& roles)
{
    static constexpr std::array<std::pair<std::string_view, std::uint32_t>, 6> known{
        {{"Observer", id::WellKnownRole_Observer},
         {"Operator", id::WellKnownRole_Operator},
         {"Engineer", id::WellKnownRole_Engineer},
         {"Supervisor", id::WellKnownRole_Supervisor},
         {"ConfigureAdmin", id::WellKnownRole_ConfigureAdmin},
         {"SecurityAdmin", id::WellKnownRole_SecurityAdmin}}};
    std::vector<NodeId> nodes;
    for (const auto& [name, node] : known) {
        if (std::find(roles.begin(), roles.end(), name) != roles.end()) {
            nodes.emplace_back(std::uint16_t{0}, node);
        }
    }
    return nodes;
}

} // namespace

FileSystems::FileSystems(const std::vector<FilesConfig>& files)
{
    for (const FilesConfig& each : files) {
        storage::FolderStorage& folder = folders_.emplace_back(each.folder);
        if (const auto made = folder.make_folder("", FileAccess::Owner); !made) {
            throw ConfigError{"files " + each.name + ": " + each.folder,
                              "the folder cannot be made: " + std::string{text(made.error())}};
        }
        all_.push_back({.name = each.name,
                        .storage = &folder,
                        .limits = each.limits,
                        .readers = nodes_named(each.readers),
                        .writers = nodes_named(each.writers)});
    }
}

} // namespace busbar::product
