#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/model/new_node.hpp>
#include <busbar/model/space_journal.hpp>
#include <busbar/model/space_reader.hpp>

namespace busbar::model {

namespace detail {
class Graft;
} // namespace detail

/// The nodes of a server (Part 3): the constant ones of namespace 0, used where they lie, and any
/// number of dynamic ones that are added and removed at run time. It owns them all; what is read of
/// them is in SpaceReader, what has changed in SpaceJournal.
///
/// One thread changes an AddressSpace, and nobody reads it meanwhile.
class BUSBAR_API AddressSpace final : public SpaceReader {
public:
    /// Namespace 0 as it was built in (BUSBAR_NAMESPACE0).
    AddressSpace();
    /// `static_nodes` must outlive the object.
    explicit AddressSpace(const StaticNodes& static_nodes);
    AddressSpace(AddressSpace&&) noexcept;
    AddressSpace& operator=(AddressSpace&&) noexcept;
    ~AddressSpace();

    [[nodiscard]] SpaceJournal journal() const { return SpaceJournal{*this}; }

    // Changing. Errors are those of AddNodes and AddReferences (Part 4, 5.8.2 and 5.8.3):
    // Bad_NodeIdExists, Bad_NodeIdInvalid, Bad_BrowseNameInvalid, Bad_BrowseNameDuplicated,
    // Bad_ParentNodeIdInvalid, Bad_ReferenceTypeIdInvalid, Bad_ReferenceNotAllowed,
    // Bad_TypeDefinitionInvalid, Bad_NodeAttributesInvalid (DataType, ValueRank,
    // ArrayDimensions), Bad_OutOfMemory past 16 million dynamic nodes. A call that fails changes
    // nothing.

    /// The index of `uri`, which is added if it is new. Index 1 should be the server's own
    /// ApplicationUri. Bad_TooManyOperations past 65,535 namespaces.
    [[nodiscard]] Result<std::uint16_t> add_namespace(std::string_view uri);

    /// A numeric NodeId of the namespace, which must exist, that no node has; never given twice.
    [[nodiscard]] NodeId free_id(std::uint16_t namespace_index);
    /// Makes room for that many more dynamic nodes; only saves time.
    void reserve(std::size_t node_count);
    Result<NodeIndex> add_object(const NewNode& node, const NewObject& object = {});
    Result<NodeIndex> add_folder(const NewNode& node);
    Result<NodeIndex> add_variable(const NewNode& node, const NewVariable& variable);
    /// A Variable in one statement:
    ///     space.add_variable(parent, {ns, "Speed"}, source.variable(1480.0), Access::ReadWrite)
    /// Its NodeId is the name, as a String in the namespace of the name; below a node that has a
    /// String of that namespace: that, '/' and the name. Bad_NodeAttributesInvalid if the value is
    /// null: that of a source which no server has.
    Result<NodeIndex> add_variable(NodeIndex parent, const QualifiedName& name,
                                   const BoundValue& value, Access access = Access::Read);
    /// A Variable of PropertyType below `node.parent` by HasProperty.
    Result<NodeIndex> add_property(const NewNode& node, NewVariable variable);
    /// A Method with its properties for arguments. Others may have it too: add_reference with
    /// HasComponent makes it a component of one more Object or ObjectType.
    Result<NodeIndex> add_method(const NewNode& node, const NewMethod& method = {});
    Result<NodeIndex> add_view(const NewNode& node, bool contains_no_loops = true);
    Result<NodeIndex> add_object_type(const NewNode& node, bool is_abstract = false);
    Result<NodeIndex> add_variable_type(const NewNode& node, const NewVariableType& type);
    Result<NodeIndex> add_reference_type(const NewNode& node, const NewReferenceType& type);
    Result<NodeIndex> add_data_type(const NewNode& node, const NewDataType& type);
    /// Copies generated nodes of another namespace; namespaces are added as needed. What they refer
    /// to must be there already. Bad_NodeIdExists if one of them is there. Namespace indices in
    /// values become those of this AddressSpace, also within structures whose DataTypeDefinitions
    /// are here; bodies of others are copied as they are.
    Result<void> add(const StaticNodes& nodes);

    /// Adds the reference in both directions. Bad_DuplicateReferenceNotAllowed if it is there,
    /// Bad_ReferenceTypeIdInvalid for an abstract type or none, Bad_ReferenceNotAllowed for
    /// HasSubtype and HasTypeDefinition, which come with the nodes.
    Result<void> add_reference(NodeIndex source, const NodeId& type, NodeIndex target);
    /// Removes a reference that add_reference made; Bad_NotFound if there is none.
    Result<void> remove_reference(NodeIndex source, const NodeId& type, NodeIndex target);
    /// Removes a dynamic node, all nodes that were added below it, and all references to them.
    /// Bad_NodeIdUnknown if there is no such node, Bad_NoDeleteRights for a constant node or a
    /// type, which nothing may lose. One that has nothing below it needs no memory for that.
    Result<void> remove(NodeIndex node);

    /// Gives a Variable a value of its own. Bad_TypeMismatch as check_value.
    Result<void> set_value(NodeIndex node, Variant value);
    Result<void> set_data_value(NodeIndex node, DataValue value); // and its status and source time
    /// Makes a data source serve the Variable or carry out the Method, constant or dynamic.
    void bind(NodeIndex node, std::uint32_t source, std::uint64_t handle);
    /// Of `user_access_level` only the bits that `access_level` has count.
    void set_access_level(NodeIndex node, Access access_level,
                          Access user_access_level = Access::All);
    void set_node_access(NodeIndex node, NodeAccess access);
    /// For nodes without their own (Part 5, 6.3.13); 0 and null are none, empty denies everything.
    void set_namespace_restrictions(std::uint16_t index, std::uint16_t restrictions);
    void set_namespace_permissions(std::uint16_t index, Array<RolePermissionType> permissions);
    void set_executable(NodeIndex node, bool executable);
    void set_minimum_sampling_interval(NodeIndex node, double ms); // if it is dynamic; -1: unknown
    void set_display_name(NodeIndex node, LocalizedText text);
    void set_description(NodeIndex node, LocalizedText text);
    /// Adds or replaces a LocalizedText in one locale; an empty one removes it (Part 4, 5.11.4.1).
    Result<void> set_text(NodeIndex node, AttributeId attribute, DataValue text);

private:
    friend class detail::Graft;

    Result<NodeIndex> create(const NewNode& node, NodeClass node_class);
    Result<void> add_arguments(NodeIndex method, const NewMethod& from);
};

} // namespace busbar::model
