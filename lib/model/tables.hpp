#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/model/space_reader.hpp>
#include <busbar/types/ids.hpp>

#include "index_table.hpp"
#include "journal.hpp"
#include "node_access_table.hpp"
#include "record.hpp"
#include "translations.hpp"
#include "watch_table.hpp"

namespace busbar::model::detail {

/// The NamespaceArray (Part 3, 8.2.2): found by its index and by its URI, however many there are.
class NamespaceTable {
public:
    [[nodiscard]] std::size_t size() const { return uris_.size(); }
    [[nodiscard]] std::string_view uri(std::size_t index) const { return uris_[index]; }
    [[nodiscard]] std::optional<std::uint16_t> find(std::string_view uri) const
    {
        const auto found = indices_.find(uri);
        return found == indices_.end() ? std::nullopt : std::optional{found->second};
    }
    /// Requires fewer than 65,536 entries. Of equal ones the first is found.
    void add(std::string_view uri)
    {
        indices_.try_emplace(std::string{uri}, static_cast<std::uint16_t>(uris_.size()));
        uris_.emplace_back(uri);
    }
    /// Removes the last entries.
    void shrink(std::size_t size)
    {
        for (; uris_.size() > size; uris_.pop_back()) {
            const auto found = indices_.find(uris_.back());
            if (found->second == uris_.size() - 1) {
                indices_.erase(found);
            }
        }
    }

private:
    struct Hash : std::hash<std::string_view> {
        using is_transparent = void;
    };

    std::vector<std::string> uris_;
    std::unordered_map<std::string, std::uint16_t, Hash, std::equal_to<>> indices_;
};

// Nodes of namespace 0 that the rules of the address space refer to.
inline constexpr std::uint32_t id_structure = id::Structure;
inline constexpr std::uint32_t id_base_data_type = id::BaseDataType;
inline constexpr std::uint32_t id_hierarchical_references = id::HierarchicalReferences;
inline constexpr std::uint32_t id_organizes = id::Organizes;
inline constexpr std::uint32_t id_has_modelling_rule = id::HasModellingRule;
inline constexpr std::uint32_t id_has_encoding = id::HasEncoding;
inline constexpr std::uint32_t id_has_type_definition = id::HasTypeDefinition;
inline constexpr std::uint32_t id_has_subtype = id::HasSubtype;
inline constexpr std::uint32_t id_has_property = id::HasProperty;
inline constexpr std::uint32_t id_has_component = id::HasComponent;
inline constexpr std::uint32_t id_base_object_type = id::BaseObjectType;
inline constexpr std::uint32_t id_folder_type = id::FolderType;
inline constexpr std::uint32_t id_base_variable_type = id::BaseVariableType;
inline constexpr std::uint32_t id_property_type = id::PropertyType;
inline constexpr std::uint32_t id_argument = id::Argument;

/// Returns an entry of a table of constant nodes, with its namespace indices mapped by `map`.
[[nodiscard]] NodeAccess node_access(const StaticNodes& nodes, const StaticAccess& from,
                                     std::span<const std::uint16_t> map);

/// The contents of an AddressSpace. Constant nodes have the indices below `constant_count`.
struct Tables {
    explicit Tables(const StaticNodes& nodes);

    static constexpr std::uint32_t block_size = 256;
    struct Block {
        std::array<NodeRecord, block_size> records;
        std::array<NodeLinks, block_size> links;
    };

    const StaticNodes* constants;
    std::uint32_t constant_count;
    NamespaceTable namespaces;
    std::vector<std::unique_ptr<Block>> blocks;
    std::uint32_t record_count{0};
    /// Each free record has the number of the next one as its id, so that freeing needs no memory.
    std::uint32_t first_free{IndexTable::none};
    std::uint32_t free_count{0};
    IndexTable by_id;
    IndexTable by_name;
    std::unordered_map<std::uint32_t, std::unique_ptr<Overlay>> overlays;
    NodeAccessTable access;
    Translations translations;
    /// Indexed by namespace; may be shorter.
    std::vector<std::uint16_t> namespace_restrictions;
    std::vector<Array<RolePermissionType>> namespace_permissions;
    Journal journal;
    WatchTable watches;
    /// See SpaceJournal.
    std::uint64_t rebindings{0};
    std::uint64_t access_changes{0};
    std::uint64_t type_count{0};
    std::uint32_t next_generation{0};
    std::vector<std::uint32_t> next_numeric_ids;
    // Looked up once, since each new node needs them.
    NodeIndex hierarchical_references;
    NodeIndex has_type_definition;
    NodeIndex has_subtype;
    NodeIndex has_property;

    [[nodiscard]] bool is_constant(NodeIndex node) const { return number(node) < constant_count; }
    [[nodiscard]] const StaticNode& constant(NodeIndex node) const
    {
        return constants->nodes[number(node)];
    }
    [[nodiscard]] const NodeRecord& at(std::uint32_t record) const
    {
        return blocks[record / block_size]->records[record % block_size];
    }
    [[nodiscard]] NodeRecord& at(std::uint32_t record)
    {
        return blocks[record / block_size]->records[record % block_size];
    }
    [[nodiscard]] const NodeRecord& record(NodeIndex node) const
    {
        return at(number(node) - constant_count);
    }
    [[nodiscard]] NodeRecord& record(NodeIndex node) { return at(number(node) - constant_count); }
    [[nodiscard]] const NodeLinks& links_at(std::uint32_t record) const
    {
        return blocks[record / block_size]->links[record % block_size];
    }
    [[nodiscard]] NodeLinks& links_at(std::uint32_t record)
    {
        return blocks[record / block_size]->links[record % block_size];
    }
    [[nodiscard]] const NodeLinks& links(NodeIndex node) const
    {
        return links_at(number(node) - constant_count);
    }
    [[nodiscard]] NodeLinks& links(NodeIndex node)
    {
        return links_at(number(node) - constant_count);
    }
    [[nodiscard]] NodeIndex index_of(std::uint32_t record_number) const
    {
        return NodeIndex{constant_count + record_number};
    }
    [[nodiscard]] const Overlay* overlay(NodeIndex node) const;
    [[nodiscard]] Overlay& make_overlay(NodeIndex node);
    /// The node's own list of references, null if it has none.
    [[nodiscard]] const ReferenceList* list(NodeIndex node) const;
    [[nodiscard]] ReferenceList& make_list(NodeIndex node);

    [[nodiscard]] std::string_view text(StaticText at) const
    {
        return constants->text.substr(at.offset, at.size);
    }
    /// Returns the node of an entry of a static table that may be past the last node.
    [[nodiscard]] NodeIndex target(std::uint32_t node_or_external) const
    {
        return node_or_external < constant_count ? NodeIndex{node_or_external} : no_node;
    }
    /// Returns its NodeId; borrowed.
    [[nodiscard]] NodeId id_of(NodeIndex node) const;
    [[nodiscard]] NodeIndex find_constant(std::uint32_t numeric_id) const;
    [[nodiscard]] NodeIndex find(const NodeId& id) const;
    /// See SpaceReader.
    void fetch_nodes(std::span<const NodeId* const> ids) const;
    void find_nodes(std::span<const NodeId* const> ids, std::span<NodeIndex> found) const;
    /// Prefetches what a Read needs of these nodes; they may be missing.
    void fetch_nodes(std::span<const NodeHandle> handles) const;
    /// Returns the first child with this name that was added below `parent` and for which `match`
    /// returns true.
    template <typename Match>
    [[nodiscard]] NodeIndex find_child(NodeIndex parent, const QualifiedName& name,
                                       Match match) const
    {
        const std::uint32_t found =
            by_name.find(name_hash(parent, name), [&](std::uint32_t candidate) {
                const NodeLinks& child_links = links_at(candidate);
                const NodeRecord& child = at(candidate);
                return child_links.parent == parent &&
                       child.name(child_links) == name.name.view() &&
                       child.browse_namespace == name.namespace_index && match(index_of(candidate));
            });
        return found == IndexTable::none ? no_node : index_of(found);
    }

    [[nodiscard]] static std::uint64_t name_hash(NodeIndex parent, const QualifiedName& name);
    [[nodiscard]] std::uint64_t id_hash(std::uint32_t record_number) const;
    [[nodiscard]] std::uint64_t name_hash(std::uint32_t record_number) const;
    [[nodiscard]] auto id_hasher() const
    {
        return [this](std::uint32_t record_number) { return id_hash(record_number); };
    }
    [[nodiscard]] auto name_hasher() const
    {
        return [this](std::uint32_t record_number) { return name_hash(record_number); };
    }

    /// Creates a record with these names that is linked to nothing yet.
    [[nodiscard]] NodeIndex create(const NodeId& id, const QualifiedName& name,
                                   NodeClass node_class);
    /// Makes `child`, a record, a child of `parent`.
    void link(NodeIndex parent, NodeIndex reference_type, NodeIndex child);
    /// Makes the new record `type` known as a subtype of `supertype`; of nothing if that is
    /// no_node.
    void place_type(NodeIndex type, NodeIndex supertype);
    /// Removes the record from its parent's list.
    void unlink(NodeIndex child);
    void destroy(NodeIndex node);
    void add_entry(NodeIndex node, const Entry& entry);
    /// Returns false if the entry does not exist.
    bool remove_entry(NodeIndex node, const Entry& entry);
    /// Records a change of the node in the journal, with bits of ModelChangeStructureVerbMask.
    void note(NodeIndex node, unsigned verb);
    /// Returns an unused numeric NodeId of the namespace.
    [[nodiscard]] NodeId free_id(std::uint16_t namespace_index);

private:
    /// A node that is searched: its hash, and the record that it likely has.
    struct Sought {
        std::uint64_t hash{0};
        std::uint32_t record{IndexTable::none};
    };

    void fetch_nodes(std::span<const NodeId* const> ids, std::span<Sought> sought) const;
    void share_access(const StaticNodes& nodes);
    [[nodiscard]] bool is_node_version(NodeIndex child) const;
    std::uint32_t push(NodeIndex node, const Entry& entry);
    /// Makes sure that a long list has an index with room for one more.
    void prepare_index(NodeIndex node, ReferenceList& list) const;
    void fill_index(NodeIndex node, ReferenceList& list) const;
    /// Returns the slot of an entry that add_entry() added; the size of the list if there is none.
    [[nodiscard]] std::uint32_t find_entry(NodeIndex node, const ReferenceList& list,
                                           const Entry& entry) const;
    /// Returns whether the entry in this slot leads to a child whose parent is `node`.
    [[nodiscard]] bool is_to_child(NodeIndex node, const ReferenceList& list,
                                   std::uint32_t slot) const;
    void compact(NodeIndex node, ReferenceList& list);
};

} // namespace busbar::model::detail
