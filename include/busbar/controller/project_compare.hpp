#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <busbar/controller/project.hpp>
#include <busbar/core/api.hpp>

/// Verification of one project with another (seed 001, 9.13): what differs, one by one.
namespace busbar::controller {

struct ProjectDifference {
    /// "network.host_name", "user hmi: permission", "http://press.example/press: ns=1;i=5".
    std::string where;
    /// What each side has, for people; "nothing" for what is on one side only.
    std::string first;
    std::string second;

    friend bool operator==(const ProjectDifference&, const ProjectDifference&) = default;
};

/// How many differences are listed at most.
inline constexpr std::size_t max_project_differences = 1'000;

/// All values but models; users are matched by their names. Hashes of passwords are not shown.
[[nodiscard]] BUSBAR_API std::vector<ProjectDifference> setting_differences(const Project& first,
                                                                            const Project& second);

/// Nodes and mapping of the models, which are matched by their ModelUri: each node that has other
/// attributes, references or values, and each that has another mapping. NodeIds are as the files
/// write them. Of the target busbar::model_mode, which needs pugixml.
[[nodiscard]] BUSBAR_API std::vector<ProjectDifference> model_differences(const Project& first,
                                                                          const Project& second);

} // namespace busbar::controller
