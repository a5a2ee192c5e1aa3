#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <busbar/controller/model_set.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/problem.hpp>

/// Instances of the types of imported models, so that a companion specification, which has types
/// only, can be mapped. Of the target busbar::model_mode, which needs pugixml.
namespace busbar::controller {

/// What becomes part of a project's models.
struct NewInstance {
    /// Of ModelSet::space().
    NodeId parent{};
    /// An ObjectType or VariableType that is not abstract.
    NodeId type{};
    /// The BrowseName, which is also the end of the NodeId.
    std::string name{};
    /// The namespace of its nodes, which is made if the project has none of this URI: no companion
    /// specification's, whose nodes are those of its file.
    std::string uri{};
    /// BrowsePaths of Optional members, "Identification/SerialNumber".
    std::vector<std::string> optional{};
    bool has_all_optional{false};
};

struct InstanceResult {
    NodeId node{};
    /// Nodes that were added; 0 if all were there.
    std::size_t added{0};
};

/// Adds an Object or Variable with all Mandatory members of its type, the type's supertypes and
/// Interfaces, within one another, and the Optional ones that were chosen; Methods are the
/// instance's own, with their arguments. NodeIds have String identifiers, "Line/Status/Speed", so
/// that what is added again has the same; below a parent of the same namespace they begin with the
/// parent's. Where the node is there and of that type, what it lacks is added.
///
/// The nodes are a file of the ModelSet as others are, with their mapping. The problem says what
/// cannot be; the ModelSet is as before then. References to space() end.
[[nodiscard]] BUSBAR_API Configured<InstanceResult> add_instance(ModelSet& models,
                                                                 const NewInstance& instance);

} // namespace busbar::controller
