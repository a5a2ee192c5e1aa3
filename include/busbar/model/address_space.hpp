#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/binary/type_registry.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/model/node.hpp>
#include <busbar/model/node_watch.hpp>
#include <busbar/model/static_nodes.hpp>

namespace busbar::model {

namespace detail {
class Graft;
struct Tables;
struct Entry;
} // namespace detail

/// Walks the references of one node; valid until the AddressSpace changes.
///
/// An inverse HasTypeDefinition is not kept, which would cost each node 8 bytes: next_instance
/// finds the instances of a type. Nor is an inverse HasModellingRule (Part 3, 4.4.3 lets a
/// reference be followed in one direction only).
class BUSBAR_API ReferenceCursor {
public:
    /// The next reference, or nothing at the end.
    [[nodiscard]] std::optional<Reference> next();
    /// How many references were passed; AddressSpace::references continues there.
    [[nodiscard]] std::size_t position() const { return position_; }
    /// No more than this many references follow.
    [[nodiscard]] std::size_t at_most() const { return end_ - position_; }

private:
    friend class AddressSpace;

    const StaticNodes* static_nodes_{nullptr};
    const StaticReference* constant_{nullptr};
    std::size_t constant_count_{0};
    Reference own_[2];
    std::size_t own_count_{0};
    const detail::Entry* entries_{nullptr};
    std::size_t position_{0};
    std::size_t end_{0};
};

/// What happened to a node that has a NodeVersion (Part 5, 12.16).
struct ModelChange {
    NodeId affected;
    /// The TypeDefinition of an Object or Variable, else null.
    NodeId affected_type;
    /// Bits of ModelChangeStructureVerbMask.
    std::uint8_t verb{0};
};

struct ModelChanges {
    /// One for each node, in the order of their first changes. Own their strings.
    std::vector<ModelChange> changes;
    /// False if there were more than are kept.
    bool is_complete{true};
};

/// The nodes of a server (Part 3): the constant ones of namespace 0, used where they lie, and any
/// number of dynamic ones that are added and removed at run time.
///
/// Strings in results of const functions are borrowed from the AddressSpace and valid until the
/// node they belong to is removed. A function that takes a NodeIndex takes only that of an
/// existing node unless it says otherwise. May be read from many threads while none changes it.
class BUSBAR_API AddressSpace {
public:
    /// Namespace 0 as it was built in (BUSBAR_NAMESPACE0).
    AddressSpace();
    /// `static_nodes` must outlive the object.
    explicit AddressSpace(const StaticNodes& static_nodes);
    AddressSpace(AddressSpace&&) noexcept;
    AddressSpace& operator=(AddressSpace&&) noexcept;
    ~AddressSpace();

    // Namespaces (Part 3, 8.2.2).

    [[nodiscard]] std::size_t namespace_count() const;
    [[nodiscard]] std::string_view namespace_uri(std::uint16_t index) const;
    [[nodiscard]] std::optional<std::uint16_t> namespace_index(std::string_view uri) const;
    /// The index of `uri`, which is added if it is new. Index 1 should be the server's own
    /// ApplicationUri. Bad_TooManyOperations past 65,535 namespaces.
    [[nodiscard]] Result<std::uint16_t> add_namespace(std::string_view uri);

    // Looking up.

    [[nodiscard]] NodeIndex find(const NodeId& id) const;
    [[nodiscard]] NodeIndex find(std::uint32_t namespace0_id) const;
    [[nodiscard]] NodeHandle handle(NodeIndex node) const;
    /// The node of the handle, no_node if it was removed.
    [[nodiscard]] NodeIndex resolve(NodeHandle handle) const;
    /// True for the index of an existing node; any number may be asked for.
    [[nodiscard]] bool exists(NodeIndex node) const;
    [[nodiscard]] std::size_t node_count() const;
    /// Counts the dynamic nodes that were ever added, by calls that failed too; goes round.
    [[nodiscard]] std::uint32_t addition_count() const;
    /// Calls `visit` for each node.
    void for_each(FunctionRef<void(NodeIndex)> visit) const;

    // Attributes (Part 3, 5).

    [[nodiscard]] NodeClass node_class(NodeIndex node) const;
    [[nodiscard]] NodeId node_id(NodeIndex node) const;
    [[nodiscard]] QualifiedName browse_name(NodeIndex node) const;
    [[nodiscard]] LocalizedText display_name(NodeIndex node) const;
    /// Of a Variable or VariableType; for others the defaults.
    [[nodiscard]] VariableAttributes variable(NodeIndex node) const;
    /// Of a Method; for others the defaults.
    [[nodiscard]] MethodAttributes method(NodeIndex node) const;
    /// Null if the node has nothing of these; valid until it is changed.
    [[nodiscard]] const NodeAccess* node_access(NodeIndex node) const;
    /// The AccessRestrictions that count for the node: its own or those of its namespace (Part 3,
    /// 5.2.11). The server enforces them.
    [[nodiscard]] std::uint16_t access_restrictions(NodeIndex node) const;
    /// The NodeId of a Variable's DataType even if that node is left out of a small namespace 0.
    [[nodiscard]] NodeId data_type_id(NodeIndex node) const;
    /// Any attribute but Value and UserRolePermissions, whoever asks. Bad_AttributeIdInvalid if the
    /// node has none such.
    [[nodiscard]] Result<Variant> attribute(NodeIndex node, AttributeId id) const;
    /// True if nodes of the class have the attribute, mandatory or optional.
    [[nodiscard]] static bool has_attribute(NodeClass node_class, AttributeId id);
    /// The value of a Variable or VariableType without source; null if it was never given one.
    /// Structures stay encoded unless `types` is given and knows them.
    [[nodiscard]] Variant value(NodeIndex node, const binary::TypeRegistry* types = nullptr) const;

    // References and types.

    /// Calls `visit` for the node and all that remove() takes along, parents first, until it
    /// returns false.
    void for_each_below(NodeIndex node, FunctionRef<bool(NodeIndex)> visit) const;
    [[nodiscard]] ReferenceCursor references(NodeIndex node, std::size_t position = 0) const;
    /// The first instance of an ObjectType or VariableType itself, not of its subtypes, from index
    /// `from` on; no_node if there is none. Looks at every node and takes one off `visits` for
    /// each, until there are none left. `from` becomes where to go on, no_node at the end.
    [[nodiscard]] NodeIndex next_instance(NodeIndex type, NodeIndex& from,
                                          std::size_t& visits) const;
    /// Has `watch` told of the next change of that aspect of the node, or of its removal.
    void watch(NodeIndex node, NodeAspect aspect, NodeWatch& watch) const;
    /// Changes whenever a type was added; types are never removed.
    [[nodiscard]] std::uint64_t type_count() const;
    /// The target of HasTypeDefinition of an Object or Variable, else no_node.
    [[nodiscard]] NodeIndex type_definition(NodeIndex node) const;
    /// The IsAbstract attribute of a type.
    [[nodiscard]] bool is_abstract(NodeIndex type) const;
    /// The type above, no_node for one that has none.
    [[nodiscard]] NodeIndex supertype(NodeIndex type) const;
    /// True if `type` is `supertype` or below it along HasSubtype; false if either is no type or
    /// no_node. Takes constant time.
    [[nodiscard]] bool is_subtype_of(NodeIndex type, NodeIndex supertype) const;
    /// As above for a type of namespace 0 by its number.
    [[nodiscard]] bool is_subtype_of(NodeIndex type, std::uint32_t supertype) const;
    /// Calls `visit` for each forward target by a hierarchical reference of `type` (or of a
    /// subtype) whose BrowseName is `name`, until it returns false. Does not scan the children
    /// that were added with `parent` as their parent. Gives how many references it looked at.
    std::size_t for_each_child(NodeIndex parent, NodeIndex type, bool include_subtypes,
                               const QualifiedName& name, FunctionRef<bool(NodeIndex)> visit) const;

    /// The built-in type that encodes values of the DataType: Int32 for an enumeration,
    /// ExtensionObject for a structure, Variant for the abstract BaseDataType, Number, Integer and
    /// UInteger; Null if it is no DataType.
    [[nodiscard]] BuiltInType built_in_type_of(NodeIndex data_type) const;
    /// One bit for each BuiltInType that a value of the DataType may have; bit 0: also no value.
    [[nodiscard]] std::uint32_t built_in_types_of(NodeIndex data_type) const;
    /// Good, or Bad_TypeMismatch if `value` cannot be the Value of a Variable of these attributes
    /// (Part 4, 5.11.4; Part 3, 5.6.2). A scalar ByteString may stand for an array of Byte.
    [[nodiscard]] StatusCode check_value(const Variant& value, NodeIndex data_type,
                                         std::int32_t value_rank,
                                         std::span<const std::uint32_t> array_dimensions) const;

    // Changing. Errors are those of AddNodes and AddReferences (Part 4, 5.8.2 and 5.8.3):
    // Bad_NodeIdExists, Bad_NodeIdInvalid, Bad_BrowseNameInvalid, Bad_BrowseNameDuplicated,
    // Bad_ParentNodeIdInvalid, Bad_ReferenceTypeIdInvalid, Bad_ReferenceNotAllowed,
    // Bad_TypeDefinitionInvalid, Bad_NodeAttributesInvalid (DataType, ValueRank,
    // ArrayDimensions), Bad_OutOfMemory past 16 million dynamic nodes. A call that fails changes
    // nothing.

    /// A numeric NodeId of the namespace that no node has, and that is not given twice.
    [[nodiscard]] NodeId free_id(std::uint16_t namespace_index);
    /// True if there is something for take_changes.
    [[nodiscard]] bool has_changes() const;
    /// What happened since the last call to nodes that have the property NodeVersion, the only ones
    /// of which clients are told (Part 3, 9.32.2). Keeps 1,000 of them; further ones are lost, and
    /// `is_complete` says so.
    [[nodiscard]] ModelChanges take_changes();
    /// The property NodeVersion that was added to the node, no_node if none was.
    [[nodiscard]] NodeIndex node_version(NodeIndex node) const;
    /// Calls `visit` with each of these properties.
    void for_each_node_version(FunctionRef<void(NodeIndex)> visit) const;

    /// Makes room for that many more dynamic nodes; only saves time.
    void reserve(std::size_t node_count);
    /// A numeric NodeId of the namespace that no node has, for the next node that is added. The
    /// namespace must exist.
    [[nodiscard]] NodeId free_node_id(std::uint16_t namespace_index);
    Result<NodeIndex> add_object(const NewNode& node, const NewObject& object = {});
    /// An Object of FolderType.
    Result<NodeIndex> add_folder(const NewNode& node);
    Result<NodeIndex> add_variable(const NewNode& node, const NewVariable& variable);
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
    /// Copies generated nodes of another namespace, whose namespaces are added as needed. What they
    /// refer to must be there already. Bad_NodeIdExists if one of them is. Namespace indices in
    /// values become those of this AddressSpace, also within structures whose DataTypeDefinitions
    /// are here; bodies of others are taken over as they are.
    Result<void> add(const StaticNodes& nodes);

    /// Adds the reference in both directions. Bad_DuplicateReferenceNotAllowed if it is there,
    /// Bad_ReferenceTypeIdInvalid for an abstract type or none, Bad_ReferenceNotAllowed for
    /// HasSubtype and HasTypeDefinition, which come with the nodes.
    Result<void> add_reference(NodeIndex source, const NodeId& type, NodeIndex target);
    /// Removes a reference that add_reference made; Bad_NotFound if there is none.
    Result<void> remove_reference(NodeIndex source, const NodeId& type, NodeIndex target);
    /// Removes a dynamic node, all nodes that were added below it, and all references to them.
    /// Bad_NodeIdUnknown if there is no such node, Bad_NoDeleteRights for a constant node or a
    /// type, which nothing may lose.
    Result<void> remove(NodeIndex node);

    /// Gives a Variable a value of its own. Bad_TypeMismatch as check_value.
    Result<void> set_value(NodeIndex node, Variant value);
    /// Has a data source serve the Variable or carry out the Method, constant or dynamic.
    void bind(NodeIndex node, std::uint32_t source, std::uint64_t handle);
    void set_access_level(NodeIndex node, std::uint8_t access_level,
                          std::uint8_t user_access_level);
    void set_node_access(NodeIndex node, NodeAccess access);
    /// The AccessRestrictions of the nodes of a namespace that have none of their own; 0 at first.
    void set_namespace_restrictions(std::uint16_t namespace_index, std::uint16_t restrictions);
    /// Sets the Executable attribute of a Method.
    void set_executable(NodeIndex node, bool executable);
    void set_display_name(NodeIndex node, LocalizedText text);
    void set_description(NodeIndex node, LocalizedText text);

private:
    friend class detail::Graft;

    Result<NodeIndex> create(const NewNode& node, NodeClass node_class);
    Result<void> add_arguments(NodeIndex method, const NewMethod& from);
    [[nodiscard]] Result<Variant> variable_attribute(NodeIndex node, AttributeId id) const;
    [[nodiscard]] Result<Variant> access_attribute(NodeIndex node, AttributeId id) const;
    std::unique_ptr<detail::Tables> tables_;
};

} // namespace busbar::model
