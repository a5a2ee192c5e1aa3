#include <busbar/model/address_space.hpp>

#include <algorithm>

#include "tables.hpp"

namespace busbar::model {

AddressSpace::AddressSpace(const StaticNodes& static_nodes)
    : tables_{std::make_unique<detail::Tables>(static_nodes)}
{
}

AddressSpace::AddressSpace(AddressSpace&&) noexcept = default;
AddressSpace& AddressSpace::operator=(AddressSpace&&) noexcept = default;
AddressSpace::~AddressSpace() = default;

std::size_t AddressSpace::namespace_count() const
{
    return tables_->namespaces.size();
}

std::string_view AddressSpace::namespace_uri(std::uint16_t index) const
{
    return index < namespace_count() ? std::string_view{tables_->namespaces[index]}
                                     : std::string_view{};
}

std::optional<std::uint16_t> AddressSpace::namespace_index(std::string_view uri) const
{
    const auto& uris = tables_->namespaces;
    const auto found = std::find(uris.begin(), uris.end(), uri);
    if (found == uris.end()) {
        return std::nullopt;
    }
    return static_cast<std::uint16_t>(found - uris.begin());
}

Result<std::uint16_t> AddressSpace::add_namespace(std::string_view uri)
{
    if (const auto known = namespace_index(uri)) {
        return *known;
    }
    if (namespace_count() > UINT16_MAX) {
        return fail(status::Bad_TooManyOperations);
    }
    tables_->namespaces.emplace_back(uri);
    return static_cast<std::uint16_t>(namespace_count() - 1);
}

NodeIndex AddressSpace::find(const NodeId& id) const
{
    return tables_->find(id);
}

NodeIndex AddressSpace::find(std::uint32_t namespace0_id) const
{
    return tables_->find(NodeId{0, namespace0_id});
}

NodeHandle AddressSpace::handle(NodeIndex node) const
{
    return {node, tables_->is_constant(node) ? 0 : tables_->record(node).generation};
}

NodeIndex AddressSpace::resolve(NodeHandle handle) const
{
    return exists(handle.index) && this->handle(handle.index) == handle ? handle.index : no_node;
}

bool AddressSpace::exists(NodeIndex node) const
{
    if (tables_->is_constant(node)) {
        return true;
    }
    return detail::number(node) - tables_->constant_count < tables_->record_count &&
           !tables_->record(node).is_free();
}

std::size_t AddressSpace::node_count() const
{
    return std::size_t{tables_->constant_count} + tables_->record_count -
           tables_->free_records.size();
}

void AddressSpace::for_each(FunctionRef<void(NodeIndex)> visit) const
{
    for (std::uint32_t i = 0; i < tables_->constant_count + tables_->record_count; ++i) {
        if (exists(NodeIndex{i})) {
            visit(NodeIndex{i});
        }
    }
}

NodeClass AddressSpace::node_class(NodeIndex node) const
{
    return tables_->is_constant(node) ? NodeClass{tables_->constant(node).node_class}
                                      : tables_->record(node).node_class();
}

NodeId AddressSpace::node_id(NodeIndex node) const
{
    return tables_->is_constant(node) ? NodeId{0, tables_->constant(node).id.value}
                                      : tables_->record(node).node_id();
}

QualifiedName AddressSpace::browse_name(NodeIndex node) const
{
    if (tables_->is_constant(node)) {
        const StaticNode& constant = tables_->constant(node);
        return {constant.browse_namespace, String::borrow(tables_->text(constant.browse_name))};
    }
    const detail::Record& record = tables_->record(node);
    return {record.browse_namespace, String::borrow(record.name())};
}

NodeId AddressSpace::free_node_id(std::uint16_t namespace_index)
{
    return tables_->free_id(namespace_index);
}

void AddressSpace::reserve(std::size_t node_count)
{
    tables_->blocks.reserve(tables_->blocks.size() + node_count / detail::Tables::block_size + 1);
    const std::size_t total = tables_->record_count + node_count;
    tables_->by_id.reserve(total, tables_->id_hasher());
    tables_->by_name.reserve(total, tables_->name_hasher());
}

} // namespace busbar::model
