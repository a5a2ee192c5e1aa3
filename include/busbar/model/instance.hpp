#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>

/// Creates instances of ObjectTypes and VariableTypes with everything that their ModellingRules
/// require (Part 3, 6.4).
///
/// A BrowsePath is written as the names of its nodes with '/' between them and without namespaces:
/// "Identification/SerialNumber". All functions run on the thread that may change the AddressSpace,
/// and one that fails leaves nothing behind.
namespace busbar::model {

/// The way NodeIds of the nodes of an instance are chosen. They have the namespace of the instance
/// itself, whatever the namespaces of their BrowseNames.
enum class InstanceIds : std::uint8_t {
    /// Below a node with a String identifier: that identifier, '/' and the child's name; below
    /// others as Numeric.
    Path,
    /// An unused number.
    Numeric,
};

/// The treatment of a type's Methods (Part 3, 6.4.2 leaves it to the server).
enum class InstanceMethods : std::uint8_t {
    /// Instances share the Methods of their type; a Call names the Object.
    Shared,
    /// Each instance has its own copies, so that Executable and the source that carries them out
    /// may differ. They begin with the source and handle of the type's Methods.
    Copied,
};

/// Limits what one call creates, since a type may contain itself. Beyond any of these it fails with
/// Bad_TooManyOperations.
struct InstanceLimits {
    std::size_t max_depth{16};
    std::size_t max_nodes{10'000};
    /// Bytes of all nodes together, as memory_of counts them.
    std::size_t max_memory{SIZE_MAX};
};

/// Estimates the memory of a node with its names, texts, value and references, in bytes. The
/// estimate is rather too high; it is meant for limits.
[[nodiscard]] BUSBAR_API std::size_t memory_of(const SpaceReader& space, NodeIndex node);

/// The member for which an instance could not be created, as its type has a choice to make.
struct InstanceFault {
    /// The BrowsePath of the member.
    std::string path{};
    /// The type of the InstanceDeclaration.
    NodeId declared_type{};
};

/// The choices that a type leaves to its instance.
struct InstanceOptions {
    /// The BrowsePaths of InstanceDeclarations with ModellingRule Optional that the instance has,
    /// together with the nodes on the way to them. Bad_NotFound if the type has no such path.
    std::vector<std::string> optional;
    /// The types of members that replace those of the InstanceDeclarations, by BrowsePath: a
    /// declaration may have an abstract type and leave the choice to the instance. Each must be the
    /// declared type or a subtype of it; else Bad_TypeDefinitionInvalid.
    std::vector<std::pair<std::string, NodeId>> types;
    /// Receives the member that a Bad_TypeDefinitionInvalid is about, unless it is null; stays as
    /// it is if that is about the instance's own type.
    InstanceFault* fault{nullptr};
    /// Adds every Optional member whose type is not abstract, or those for which the function,
    /// which may be empty, is true.
    bool all_optional{false};
    std::function<bool(std::string_view path, NodeIndex declaration)> is_wanted;
    InstanceIds ids{InstanceIds::Path};
    InstanceMethods methods{InstanceMethods::Shared};
    /// The EventNotifier of an Object.
    std::uint8_t event_notifier{0};
    /// The attributes of an instance of a VariableType that replace the type's attributes; its
    /// type_definition is ignored.
    std::optional<NewVariable> variable;
    InstanceLimits limits;
};

/// Creates an Object or Variable of `type`, which must be concrete. It gets each
/// InstanceDeclaration of the type, its supertypes and its Interfaces that is Mandatory or was
/// chosen, once for each BrowsePath and as the most derived type has it (Part 3, 6.3.3), with a
/// copy of its value. A declaration that is repeated below an InstanceDeclaration overrides that of
/// the InstanceDeclaration's own type. A node of the type that has several paths is one node of the
/// instance too, and references that are not hierarchical are copied if both ends are.
///
/// Placeholders are left to the caller, who adds nodes of the placeholder's type.
///
/// Bad_TypeDefinitionInvalid if `type` or the type of a member is abstract or not of these
/// NodeClasses, Bad_NodeAttributesInvalid if a Variable does not fit its type, Bad_NotFound and
/// Bad_TooManyOperations as above, or errors of AddressSpace.
BUSBAR_API Result<NodeIndex> instantiate(AddressSpace& space, const NewNode& node, NodeIndex type,
                                         const InstanceOptions& options = {});

/// Adds the Optional members of `instance`'s type that `options` chooses and that it does not have
/// yet, and any missing Mandatory ones. Bad_NotFound and Bad_TooManyOperations as above.
BUSBAR_API Result<void> add_optional(AddressSpace& space, NodeIndex instance,
                                     const InstanceOptions& options);

/// Makes `object` implement `interface_type`: adds HasInterface and the members that it does not
/// have yet (Part 3, 4.10.2). Bad_TypeDefinitionInvalid if that is not a subtype of
/// BaseInterfaceType.
BUSBAR_API Result<void> add_interface(AddressSpace& space, NodeIndex object,
                                      NodeIndex interface_type,
                                      const InstanceOptions& options = {});

/// Adds an instance of `type` to `parent` by HasAddIn (Part 3, 4.10.3). Its BrowseName is the
/// type's DefaultInstanceBrowseName; Bad_BrowseNameInvalid if the type has none. A null `id` is
/// chosen by InstanceOptions::ids.
BUSBAR_API Result<NodeIndex> add_add_in(AddressSpace& space, NodeIndex parent, NodeIndex type,
                                        const NodeId& id = {}, const InstanceOptions& options = {});

/// Follows hierarchical references along the names of `path`, in any namespace; no_node if there is
/// no such node.
[[nodiscard]] BUSBAR_API NodeIndex find_by_path(const SpaceReader& space, NodeIndex from,
                                                std::string_view path);

} // namespace busbar::model
