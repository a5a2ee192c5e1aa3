#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/binary/type_registry.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/model/node.hpp>
#include <busbar/model/static_nodes.hpp>

namespace busbar::model {

namespace detail {
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
    /// Number of references that were passed; SpaceReader::references continues from there.
    [[nodiscard]] std::size_t position() const { return position_; }
    /// Upper bound of the number of references that follow.
    [[nodiscard]] std::size_t at_most() const { return end_ - position_; }

private:
    friend class SpaceReader;

    const StaticNodes* static_nodes_{nullptr};
    const StaticReference* constant_{nullptr};
    std::size_t constant_count_{0};
    Reference own_[2];
    std::size_t own_count_{0};
    const detail::Entry* entries_{nullptr};
    std::size_t position_{0};
    std::size_t end_{0};
};

/// The reading half of an AddressSpace: its nodes, their attributes and references. Code that
/// changes nothing takes a `const SpaceReader&`.
///
/// Strings in results are borrowed from the AddressSpace and valid until the node they belong to is
/// removed. A function that takes a NodeIndex takes only that of an existing node unless stated
/// otherwise. Any number of threads may read while none changes the AddressSpace.
class BUSBAR_API SpaceReader {
public:
    SpaceReader(const SpaceReader&) = delete;
    SpaceReader& operator=(const SpaceReader&) = delete;

    // Namespaces (Part 3, 8.2.2).

    /// The number of namespaces, including namespace 0.
    [[nodiscard]] std::size_t namespace_count() const;
    /// Returns the URI; empty if there is no such namespace.
    [[nodiscard]] std::string_view namespace_uri(std::uint16_t index) const;
    /// Returns the index; nothing if there is no such namespace.
    [[nodiscard]] std::optional<std::uint16_t> namespace_index(std::string_view uri) const;

    // Looking up.

    /// Returns the node, no_node if there is none.
    [[nodiscard]] NodeIndex find(const NodeId& id) const;
    [[nodiscard]] NodeIndex find(std::uint32_t namespace0_id) const;
    static constexpr std::size_t fetched_together = 32;
    /// Prefetches what find() needs for the first `fetched_together` of these nodes, all at once,
    /// which takes as long as waiting for one. No pointer may be null; ids of missing nodes are
    /// allowed.
    void fetch_nodes(std::span<const NodeId* const> ids) const;
    /// Stores the result of find() for each id in `found`, which has the same size; faster than one
    /// by one. No pointer may be null.
    void find_nodes(std::span<const NodeId* const> ids, std::span<NodeIndex> found) const;
    /// Returns a handle that stays valid as long as the node exists.
    [[nodiscard]] NodeHandle handle(NodeIndex node) const;
    /// Returns the node of the handle, no_node if it was removed.
    [[nodiscard]] NodeIndex resolve(NodeHandle handle) const;
    /// Stores the result of resolve() for each handle in `found`, which has the same size; faster
    /// than one by one.
    void resolve_nodes(std::span<const NodeHandle> handles, std::span<NodeIndex> found) const;
    /// True for the index of an existing node; takes any number.
    [[nodiscard]] bool exists(NodeIndex node) const;
    /// True for a constant node, which is used in place.
    [[nodiscard]] bool is_constant(NodeIndex node) const;
    [[nodiscard]] std::size_t node_count() const;
    /// Number of dynamic nodes that were ever added, also by calls that failed; wraps around.
    [[nodiscard]] std::uint32_t addition_count() const;
    /// Calls `visit` for each node.
    void for_each(FunctionRef<void(NodeIndex)> visit) const;

    // Attributes (Part 3, 5).

    [[nodiscard]] NodeClass node_class(NodeIndex node) const;
    [[nodiscard]] NodeId node_id(NodeIndex node) const;
    [[nodiscard]] QualifiedName browse_name(NodeIndex node) const;
    [[nodiscard]] LocalizedText display_name(NodeIndex node) const;
    /// Returns the attributes of a Variable or VariableType; for others the defaults.
    [[nodiscard]] VariableAttributes variable(NodeIndex node) const;
    /// Returns the attributes of a Method; for others the defaults.
    [[nodiscard]] MethodAttributes method(NodeIndex node) const;
    /// Returns null if the node has none of these; valid until they are changed.
    [[nodiscard]] const NodeAccess* node_access(NodeIndex node) const;
    /// Returns the AccessRestrictions that apply to the node: its own or those of its namespace
    /// (Part 3, 5.2.11). The server enforces them.
    [[nodiscard]] std::uint16_t access_restrictions(NodeIndex node) const;
    /// Returns the RolePermissions that apply to the node: its own or those of its namespace (Part
    /// 3, 5.2.9); null if there are none. Valid until they are changed. The server enforces them.
    [[nodiscard]] const Array<RolePermissionType>* role_permissions(NodeIndex node) const;
    /// Return what set_namespace_permissions and set_namespace_restrictions set for a namespace.
    [[nodiscard]] Array<RolePermissionType>
    namespace_permissions(std::uint16_t namespace_index) const;
    [[nodiscard]] std::uint16_t namespace_restrictions(std::uint16_t namespace_index) const;
    /// Returns the NodeId of a Variable's DataType even if that node is missing in a small
    /// namespace 0.
    [[nodiscard]] NodeId data_type_id(NodeIndex node) const;
    /// Returns any attribute except Value and UserRolePermissions, for no particular user:
    /// UserWriteMask is 0. Bad_AttributeIdInvalid if the node does not have it.
    [[nodiscard]] Result<Variant> attribute(NodeIndex node, AttributeId id) const;
    /// True if nodes of the class have the attribute, mandatory or optional.
    [[nodiscard]] static bool has_attribute(NodeClass node_class, AttributeId id);
    /// Returns the value of a Variable or VariableType without a source; null if none was ever set.
    /// Structures stay encoded unless `types` is given and knows them.
    [[nodiscard]] Variant value(NodeIndex node, const binary::TypeRegistry* types = nullptr) const;
    /// Returns the value with the status and source timestamp of set_data_value.
    [[nodiscard]] DataValue data_value(NodeIndex node) const;

    // Texts in several locales (Part 4, 5.4): of DisplayName, Description, InverseName, and of a
    // Value that is one LocalizedText.

    /// Replaces `text`, the attribute's own, by the one that comes first in `locales`, if there is
    /// one. Borrowed until the attribute changes. 16 locales and 100 texts take a few microseconds.
    void translate(NodeIndex node, AttributeId attribute, std::span<const std::string> locales,
                   LocalizedText& text) const;
    /// Returns all texts of the attribute, the first one first; one for each locale.
    [[nodiscard]] std::vector<LocalizedText> texts(NodeIndex node, AttributeId attribute) const;
    /// True if an attribute of the node has texts in several locales.
    [[nodiscard]] bool has_further_texts(NodeIndex node) const;
    /// Returns the locales that further texts have or had, each once; valid until a text is added.
    [[nodiscard]] std::span<const std::string> further_locales() const;

    // References and types.

    /// Calls `visit` for the node and all nodes that remove() would remove with it, parents first,
    /// until it returns false.
    void for_each_below(NodeIndex node, FunctionRef<bool(NodeIndex)> visit) const;
    /// Returns the references of a node, from a position of an earlier cursor on.
    [[nodiscard]] ReferenceCursor references(NodeIndex node, std::size_t position = 0) const;
    /// Returns the first instance of an ObjectType or VariableType itself, not of its subtypes,
    /// from index `from` on; no_node if there is none. Looks at every node and counts `visits` down
    /// for each; stops when that is 0. `from` becomes the index to continue with, no_node at the
    /// end.
    [[nodiscard]] NodeIndex next_instance(NodeIndex type, NodeIndex& from,
                                          std::size_t& visits) const;
    /// A number that changes whenever a type is added; types are never removed.
    [[nodiscard]] std::uint64_t type_count() const;
    /// Returns the target of HasTypeDefinition of an Object or Variable, else no_node.
    [[nodiscard]] NodeIndex type_definition(NodeIndex node) const;
    /// Returns the IsAbstract attribute of a type.
    [[nodiscard]] bool is_abstract(NodeIndex type) const;
    /// Returns the supertype, no_node if there is none.
    [[nodiscard]] NodeIndex supertype(NodeIndex type) const;
    /// True if `type` is `supertype` or below it along HasSubtype; false if either is not a type or
    /// is no_node. Takes constant time.
    [[nodiscard]] bool is_subtype_of(NodeIndex type, NodeIndex supertype) const;
    /// Compares as above, with a type of namespace 0 by its number.
    [[nodiscard]] bool is_subtype_of(NodeIndex type, std::uint32_t supertype) const;
    /// Calls `visit` for each forward target by a hierarchical reference of `type` (or of a
    /// subtype) whose BrowseName is `name`, until it returns false. Does not scan the children that
    /// were added with `parent` as their parent. Returns the number of references that it looked
    /// at.
    std::size_t for_each_child(NodeIndex parent, NodeIndex type, bool include_subtypes,
                               const QualifiedName& name, FunctionRef<bool(NodeIndex)> visit) const;

    /// Returns the built-in type that encodes values of the DataType: Int32 for an enumeration,
    /// ExtensionObject for a structure, Variant for the abstract BaseDataType, Number, Integer and
    /// UInteger; Null if it is not a DataType.
    [[nodiscard]] BuiltInType built_in_type_of(NodeIndex data_type) const;
    /// Returns one bit for each BuiltInType that a value of the DataType may have; bit 0 means that
    /// it may be null.
    [[nodiscard]] std::uint32_t built_in_types_of(NodeIndex data_type) const;
    /// Returns the DataType of the value itself: for an array of structures that of the first
    /// element; no_node if the value is null.
    [[nodiscard]] NodeIndex type_of_value(const Variant& value) const;
    /// Returns Good, or Bad_TypeMismatch if `value` cannot be the Value of a Variable with these
    /// attributes (Part 4, 5.11.4; Part 3, 5.6.2). A scalar ByteString may stand for an array of
    /// Byte.
    [[nodiscard]] StatusCode check_value(const Variant& value, NodeIndex data_type,
                                         std::int32_t value_rank,
                                         std::span<const std::uint32_t> array_dimensions) const;

protected:
    explicit SpaceReader(std::unique_ptr<detail::Tables> tables);
    SpaceReader(SpaceReader&&) noexcept;
    SpaceReader& operator=(SpaceReader&&) noexcept;
    ~SpaceReader();

    std::unique_ptr<detail::Tables> tables_;

private:
    friend class SpaceJournal;

    [[nodiscard]] Result<Variant> variable_attribute(NodeIndex node, AttributeId id) const;
    [[nodiscard]] Result<Variant> access_attribute(NodeIndex node, AttributeId id) const;
};

} // namespace busbar::model
