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

/// The nodes of a server (Part 3): the constant ones of namespace 0, used in place, and any number
/// of dynamic ones that are added and removed at run time. It owns them all. SpaceReader reads
/// them, SpaceJournal tells what has changed.
///
/// One thread changes an AddressSpace, and no other thread reads it meanwhile.
class BUSBAR_API AddressSpace final : public SpaceReader {
public:
    /// Begins with namespace 0 as it was built in (BUSBAR_NAMESPACE0).
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
    // Bad_TypeDefinitionInvalid, Bad_NodeAttributesInvalid (DataType, ValueRank, ArrayDimensions),
    // Bad_EncodingError (not UTF-8), Bad_OutOfMemory (16 million nodes). A failure changes nothing.

    /// Returns the index of `uri`, which is added if it is new. Index 1 should be the server's own
    /// ApplicationUri. Bad_TooManyOperations past 65,535 namespaces.
    [[nodiscard]] Result<std::uint16_t> add_namespace(std::string_view uri);

    /// Returns an unused numeric NodeId of the namespace, which must exist; each only once.
    [[nodiscard]] NodeId free_id(std::uint16_t namespace_index);
    /// Reserves memory for this many more dynamic nodes; only saves time.
    void reserve(std::size_t node_count);
    Result<NodeIndex> add_object(const NewNode& node, const NewObject& object = {});
    Result<NodeIndex> add_folder(const NewNode& node);
    Result<NodeIndex> add_variable(const NewNode& node, const NewVariable& variable);
    /// Adds a Variable in one statement:
    ///     space.add_variable(parent, {ns, "Speed"}, source.variable(1480.0), Access::ReadWrite)
    /// Its NodeId is the name, as a String in the namespace of the name; below a node with a String
    /// of that namespace it is that String, '/' and the name. Bad_NodeAttributesInvalid if the
    /// value is null, as that of a source which no server has.
    Result<NodeIndex> add_variable(NodeIndex parent, const QualifiedName& name,
                                   const BoundValue& value, Access access = Access::Read);
    /// Adds a Variable of PropertyType below `node.parent` by HasProperty.
    Result<NodeIndex> add_property(const NewNode& node, NewVariable variable);
    /// Adds a Method with its properties for arguments. To share it, add_reference with
    /// HasComponent makes it a component of one more Object or ObjectType.
    Result<NodeIndex> add_method(const NewNode& node, const NewMethod& method = {});
    Result<NodeIndex> add_view(const NewNode& node, bool contains_no_loops = true);
    Result<NodeIndex> add_object_type(const NewNode& node, bool is_abstract = false);
    Result<NodeIndex> add_variable_type(const NewNode& node, const NewVariableType& type);
    Result<NodeIndex> add_reference_type(const NewNode& node, const NewReferenceType& type);
    Result<NodeIndex> add_data_type(const NewNode& node, const NewDataType& type);
    /// Copies generated nodes of another namespace; namespaces are added as needed. The nodes that
    /// they refer to must exist already. Bad_NodeIdExists if one of them exists already. Namespace
    /// indices in values become those of this AddressSpace, also within structures whose
    /// DataTypeDefinitions it has; bodies of others are copied as they are.
    Result<void> add(const StaticNodes& nodes);

    /// Adds the reference in both directions. Bad_DuplicateReferenceNotAllowed if it exists,
    /// Bad_ReferenceTypeIdInvalid for an abstract or unknown type, Bad_ReferenceNotAllowed for
    /// HasSubtype and HasTypeDefinition, which are added with their nodes.
    Result<void> add_reference(NodeIndex source, const NodeId& type, NodeIndex target);
    /// Removes a reference that add_reference made; Bad_NotFound if there is none.
    Result<void> remove_reference(NodeIndex source, const NodeId& type, NodeIndex target);
    /// Removes a dynamic node, all nodes that were added below it, and all references to them.
    /// Bad_NodeIdUnknown if it does not exist, Bad_NoDeleteRights for a constant node or a type,
    /// which must stay. Removing a node with nothing below it needs no memory.
    Result<void> remove(NodeIndex node);

    /// Gives a Variable a value. Bad_TypeMismatch as check_value.
    Result<void> set_value(NodeIndex node, Variant value);
    Result<void> set_data_value(NodeIndex node, DataValue value); // with status and source time
    /// Lets a data source serve the Variable or carry out the Method, constant or dynamic.
    void bind(NodeIndex node, std::uint32_t source, std::uint64_t handle);
    /// Bits of `user_access_level` that `access_level` does not have are ignored.
    void set_access_level(NodeIndex node, Access access_level,
                          Access user_access_level = Access::All);
    void set_node_access(NodeIndex node, NodeAccess access);
    /// For nodes without their own (Part 5, 6.3.13); 0 and null mean none, an empty array denies
    /// everything.
    void set_namespace_restrictions(std::uint16_t index, std::uint16_t restrictions);
    void set_namespace_permissions(std::uint16_t index, Array<RolePermissionType> permissions);
    void set_executable(NodeIndex node, bool executable);
    void set_minimum_sampling_interval(NodeIndex node, double ms); // of a dynamic node; -1: unknown
    void set_display_name(NodeIndex node, LocalizedText text);     // ignored if it is not UTF-8
    void set_description(NodeIndex node, LocalizedText text);      // likewise
    /// Adds or replaces a LocalizedText in one locale; an empty one removes it (Part 4, 5.11.4.1).
    Result<void> set_text(NodeIndex node, AttributeId attribute, DataValue text);

private:
    friend class detail::Graft;

    Result<NodeIndex> create(const NewNode& node, NodeClass node_class);
    Result<void> add_arguments(NodeIndex method, const NewMethod& from);
};

} // namespace busbar::model
