#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <busbar/controller/model_set.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/problem.hpp>

/// Instances of the types of imported models, so that a companion specification, which has types
/// only, can be mapped. In the target busbar::model_mode, which needs pugixml.
namespace busbar::controller {

/// An instance that is to be added to a project's models.
struct NewInstance {
    /// A node of ModelSet::space().
    NodeId parent{};
    /// An ObjectType or VariableType that is not abstract.
    NodeId type{};
    /// The BrowseName, which is also the end of the NodeId.
    std::string name{};
    /// The namespace of its nodes, which is created if the project has none of this URI. It cannot
    /// be that of a companion specification, whose nodes are those of its file.
    std::string uri{};
    /// BrowsePaths of Optional members, "Identification/SerialNumber".
    std::vector<std::string> optional{};
    bool has_all_optional{false};
    /// The types of members that replace those of the model, by BrowsePath: a member of an abstract
    /// type needs one. Each is a subtype of the model's type that is not abstract.
    std::vector<std::pair<std::string, NodeId>> types{};
};

/// The node of the instance, and what was added for it.
struct InstanceResult {
    NodeId node{};
    /// Nodes that were added; 0 if all were there.
    std::size_t added{0};
};

/// Adds an Object or Variable with all Mandatory members of its type, the type's supertypes and
/// Interfaces, within one another, and the Optional ones that were chosen; Methods are the
/// instance's own, with their arguments. NodeIds have String identifiers, "Line/Status/Speed", so
/// that nodes that are added again have the same ones; below a parent of the same namespace they
/// begin with the parent's. If the node exists and has that type, its missing members are added.
///
/// The nodes form a file of the ModelSet like others, with their mapping. The problem says what is
/// not possible; the ModelSet is unchanged then. References to space() become invalid.
[[nodiscard]] BUSBAR_API Configured<InstanceResult> add_instance(ModelSet& models,
                                                                 const NewInstance& instance);

} // namespace busbar::controller
