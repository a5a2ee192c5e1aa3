#include "tables.hpp"

#include <map>
#include <tuple>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::model::detail {

namespace {

constexpr auto reference_added =
    static_cast<unsigned>(ModelChangeStructureVerbMask::ReferenceAdded);
constexpr auto reference_deleted =
    static_cast<unsigned>(ModelChangeStructureVerbMask::ReferenceDeleted);

/// Shorter lists are searched as fast without an index.
constexpr std::size_t min_indexed = 64;

std::uint64_t entry_hash(const Entry& entry)
{
    // The multiplier of MurmurHash3's finalizer.
    const std::uint64_t bits =
        ((std::uint64_t{number(entry.target)} << 32U) | entry.type_bits) * 0xFF51AFD7ED558CCDU;
    return bits ^ (bits >> 32U);
}

auto entry_hasher(const ReferenceList& references)
{
    return [&](std::uint32_t slot) { return entry_hash(references.entries[slot]); };
}

} // namespace

Tables::Tables(const StaticNodes& nodes)
    : constants{&nodes}, constant_count{static_cast<std::uint32_t>(nodes.nodes.size())},
      hierarchical_references{find_constant(id_hierarchical_references)},
      has_type_definition{find_constant(id_has_type_definition)},
      has_subtype{find_constant(id_has_subtype)}, has_property{find_constant(id_has_property)}
{
    for (const StaticText& uri : nodes.namespaces) {
        namespaces.add(text(uri));
    }
    share_access(nodes);
}

void Tables::share_access(const StaticNodes& nodes)
{
    const auto content = [](const StaticAccess& each) {
        return std::tuple{each.role_permissions.offset,
                          each.role_permissions.size,
                          each.restrictions,
                          each.has_restrictions,
                          each.write_mask,
                          each.more_access_levels};
    };
    std::map<decltype(content(StaticAccess{})), std::shared_ptr<const NodeAccess>> shared;
    for (const StaticAccess& each : nodes.access) {
        auto& one = shared[content(each)];
        if (one == nullptr) {
            one = std::make_shared<const NodeAccess>(node_access(nodes, each, {}));
        }
        access.share(NodeIndex{each.node}, one);
    }
}

const Overlay* Tables::overlay(NodeIndex node) const
{
    const auto found = overlays.find(number(node));
    return found == overlays.end() ? nullptr : found->second.get();
}

Overlay& Tables::make_overlay(NodeIndex node)
{
    auto& overlay = overlays[number(node)];
    if (overlay == nullptr) {
        overlay = std::make_unique<Overlay>();
    }
    return *overlay;
}

const ReferenceList* Tables::list(NodeIndex node) const
{
    if (!is_constant(node)) {
        return links(node).references.get();
    }
    const Overlay* const found = overlay(node);
    return found == nullptr ? nullptr : &found->references;
}

ReferenceList& Tables::make_list(NodeIndex node)
{
    if (is_constant(node)) {
        return make_overlay(node).references;
    }
    auto& references = links(node).references;
    if (references == nullptr) {
        references = std::make_unique<ReferenceList>();
    }
    return *references;
}

NodeIndex Tables::find_constant(std::uint32_t numeric_id) const
{
    const auto slots = constants->slots;
    if (slots.empty()) {
        return no_node;
    }
    for (std::size_t at = static_slot(numeric_id, slots.size());; at = (at + 1) % slots.size()) {
        const std::uint16_t slot = slots[at];
        if (slot == 0) {
            return no_node;
        }
        if (constants->nodes[slot - 1U].id.value == numeric_id) {
            return NodeIndex{slot - 1U};
        }
    }
}

NodeIndex Tables::find(const NodeId& id) const
{
    if (id.namespace_index() == 0 && id.is_numeric()) {
        const NodeIndex found = find_constant(id.numeric());
        if (found != no_node) {
            return found;
        }
    }
    const std::uint32_t found = by_id.find(
        hash_value(id), [&](std::uint32_t candidate) { return at(candidate).has_id(id); });
    return found == IndexTable::none ? no_node : index_of(found);
}

std::uint64_t Tables::name_hash(NodeIndex parent, const QualifiedName& name)
{
    const NodeId key{name.namespace_index, String::borrow(name.name.view())};
    const std::uint64_t mixed = (hash_value(key) + number(parent)) * 0x9E37'79B9'7F4A'7C15U;
    return mixed ^ mixed >> 32U;
}

std::uint64_t Tables::id_hash(std::uint32_t record_number) const
{
    return hash_value(at(record_number).node_id());
}

std::uint64_t Tables::name_hash(std::uint32_t record_number) const
{
    const NodeRecord& node = at(record_number);
    const NodeLinks& links = links_at(record_number);
    return name_hash(links.parent,
                     QualifiedName{node.browse_namespace, String::borrow(node.name(links))});
}

NodeIndex Tables::create(const NodeId& id, const QualifiedName& name, NodeClass node_class)
{
    by_id.make_room(id_hasher());
    const bool is_reused = free_count != 0;
    const std::uint32_t number_of_record = is_reused ? first_free : record_count;
    if (number_of_record == blocks.size() * block_size) {
        blocks.push_back(std::make_unique<Block>());
    }
    NodeRecord& node = at(number_of_record);
    const std::uint32_t next_free = node.id;
    busbar::detail::Undo undo{[&] {
        node = NodeRecord{};
        links_at(number_of_record) = NodeLinks{};
        node.id = next_free;
    }};
    node.set_names(id, name, links_at(number_of_record));
    undo.keep();
    // From here on nothing can fail.
    if (is_reused) {
        first_free = next_free;
        --free_count;
    } else {
        ++record_count;
    }
    node.generation = ++next_generation;
    node.class_bits = static_cast<std::uint8_t>(node_class);
    by_id.insert(hash_value(id), number_of_record, id_hasher());
    return index_of(number_of_record);
}

void Tables::link(NodeIndex parent, NodeIndex reference_type, NodeIndex child)
{
    NodeLinks& links_of = links(child);
    by_name.make_room(name_hasher());
    links_of.parent_slot = push(parent, Entry{reference_type, child, true});
    links_of.parent = parent;
    links_of.parent_reference = reference_type;
    const std::uint32_t number_of_record = number(child) - constant_count;
    by_name.insert(name_hash(number_of_record), number_of_record, name_hasher());
    if (is_node_version(child)) {
        journal.begin(parent, child);
        note(parent, reference_added);
    }
}

void Tables::place_type(NodeIndex type, NodeIndex supertype)
{
    Extra& extra = record(type).make_extra();
    if (supertype != no_node && is_constant(supertype)) {
        extra.constant_base = supertype;
    } else if (supertype != no_node) {
        const Extra& above = record(supertype).make_extra();
        extra.constant_base = above.constant_base;
        extra.chain = above.chain;
    }
    extra.chain.push_back(type);
    ++type_count;
}

void Tables::unlink(NodeIndex child)
{
    NodeLinks& links_of = links(child);
    if (links_of.parent == no_node) {
        return;
    }
    const std::uint32_t number_of_record = number(child) - constant_count;
    by_name.erase(name_hash(number_of_record), number_of_record, name_hasher());
    ReferenceList& references = make_list(links_of.parent);
    references.entries[links_of.parent_slot] = {};
    ++references.holes;
    watches.tell(links_of.parent, NodeAspect::References);
    note(links_of.parent, reference_deleted);
    if (journal.property_of(links_of.parent) == child) {
        journal.end(links_of.parent);
    }
    links_of.parent = no_node;
}

void Tables::destroy(NodeIndex node)
{
    const std::uint32_t number_of_record = number(node) - constant_count;
    by_id.erase(id_hash(number_of_record), number_of_record, id_hasher());
    access.erase(node);
    translations.erase(node);
    // The last source before no_source belongs to the server: its values are looked up when they
    // are read.
    rebindings += record(node).source < no_source - 1 ? 1U : 0U;
    record(node) = NodeRecord{};
    links(node) = NodeLinks{};
    record(node).id = std::exchange(first_free, number_of_record);
    ++free_count;
    watches.tell_removed(node);
}

std::uint32_t Tables::push(NodeIndex node, const Entry& entry)
{
    ReferenceList& references = make_list(node);
    const std::size_t size = references.entries.size();
    if (size == references.entries.capacity() && references.holes > size / 2) {
        compact(node, references);
    }
    references.entries.push_back(entry);
    watches.tell(node, NodeAspect::References);
    note(node, reference_added);
    return static_cast<std::uint32_t>(references.entries.size() - 1);
}

void Tables::compact(NodeIndex node, ReferenceList& references)
{
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < references.entries.size(); ++i) {
        const Entry entry = references.entries[i];
        if (entry.is_hole()) {
            continue;
        }
        if (!is_constant(entry.target)) {
            NodeLinks& child = links(entry.target);
            if (child.parent == node && child.parent_slot == i) {
                child.parent_slot = kept;
            }
        }
        references.entries[kept++] = entry;
    }
    references.entries.resize(kept);
    references.holes = 0;
    if (references.index != nullptr) {
        references.index->clear();
        fill_index(node, references);
    }
    watches.tell(node, NodeAspect::ReferencePositions);
}

void Tables::add_entry(NodeIndex node, const Entry& entry)
{
    ReferenceList& references = make_list(node);
    prepare_index(node, references);
    const std::uint32_t slot = push(node, entry);
    ++references.others;
    if (references.index != nullptr) {
        references.index->insert(entry_hash(entry), slot, entry_hasher(references));
    }
}

bool Tables::is_to_child(NodeIndex node, const ReferenceList& references, std::uint32_t slot) const
{
    const Entry& entry = references.entries[slot];
    return !is_constant(entry.target) && entry.is_forward() && links(entry.target).parent == node &&
           links(entry.target).parent_slot == slot;
}

void Tables::prepare_index(NodeIndex node, ReferenceList& references) const
{
    const std::size_t size = references.entries.size();
    if (size < min_indexed || size >= IndexTable::max_records) {
        references.index.reset();
    } else if (references.index != nullptr) {
        references.index->make_room(entry_hasher(references));
    } else {
        auto index = std::make_unique<IndexTable>();
        index->reserve(std::size_t{references.others} + 1, entry_hasher(references));
        references.index = std::move(index);
        fill_index(node, references);
    }
}

/// Needs no memory if the index has room.
void Tables::fill_index(NodeIndex node, ReferenceList& references) const
{
    for (std::uint32_t slot = 0; slot < references.entries.size(); ++slot) {
        const Entry& entry = references.entries[slot];
        if (!entry.is_hole() && !is_to_child(node, references, slot)) {
            references.index->insert(entry_hash(entry), slot, entry_hasher(references));
        }
    }
}

std::uint32_t Tables::find_entry(NodeIndex node, const ReferenceList& references,
                                 const Entry& entry) const
{
    const auto end = static_cast<std::uint32_t>(references.entries.size());
    if (references.index != nullptr) {
        const std::uint32_t slot =
            references.index->find(entry_hash(entry), [&](std::uint32_t candidate) {
                return references.entries[candidate] == entry;
            });
        return slot != IndexTable::none ? slot : end;
    }
    std::uint32_t slot = 0;
    while (slot < end &&
           !(references.entries[slot] == entry && !is_to_child(node, references, slot))) {
        ++slot;
    }
    return slot;
}

bool Tables::remove_entry(NodeIndex node, const Entry& entry)
{
    if (list(node) == nullptr) {
        return false;
    }
    ReferenceList& references = make_list(node);
    const std::uint32_t slot = find_entry(node, references, entry);
    if (slot == references.entries.size()) {
        return false;
    }
    if (references.index != nullptr) {
        references.index->erase(entry_hash(entry), slot, entry_hasher(references));
    }
    references.entries[slot] = {};
    ++references.holes;
    --references.others;
    watches.tell(node, NodeAspect::References);
    note(node, reference_deleted);
    return true;
}

NodeId Tables::free_id(std::uint16_t namespace_index)
{
    if (next_numeric_ids.size() <= namespace_index) {
        next_numeric_ids.resize(namespace_index + std::size_t{1});
    }
    NodeId id{namespace_index, 0U};
    do {
        id = NodeId{namespace_index, ++next_numeric_ids[namespace_index]};
    } while (id.is_null() || find(id) != no_node);
    return id;
}

} // namespace busbar::model::detail
