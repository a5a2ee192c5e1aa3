#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <busbar/controller/project.hpp>
#include <busbar/core/api.hpp>

/// Verification of one project with another (SH-082679, 9.13): the list of differences.
namespace busbar::controller {

/// A place in which two projects differ.
struct ProjectDifference {
    /// "network.host_name", "user hmi: permission", "http://press.example/press: ns=1;i=5".
    std::string where;
    /// The contents of each side, for people; "nothing" if it exists on the other side only.
    std::string first;
    std::string second;

    friend bool operator==(const ProjectDifference&, const ProjectDifference&) = default;
};

/// Maximum number of listed differences.
inline constexpr std::size_t max_project_differences = 1'000;

/// Compares all values except models; users are matched by their names. Password hashes are not
/// shown.
[[nodiscard]] BUSBAR_API std::vector<ProjectDifference> setting_differences(const Project& first,
                                                                            const Project& second);

/// Compares nodes and mapping of the models, which are matched by their ModelUri: reports each node
/// with different attributes, references or values, and each with a different mapping. NodeIds are
/// as in the files. In the target busbar::model_mode, which needs pugixml.
[[nodiscard]] BUSBAR_API std::vector<ProjectDifference> model_differences(const Project& first,
                                                                          const Project& second);

} // namespace busbar::controller
