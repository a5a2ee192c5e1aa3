#include <busbar/model/space_reader.hpp>

#include <algorithm>

#include "tables.hpp"

namespace busbar::model {

SpaceReader::SpaceReader(std::unique_ptr<detail::Tables> tables) : tables_{std::move(tables)} {}
SpaceReader::SpaceReader(SpaceReader&&) noexcept = default;
SpaceReader& SpaceReader::operator=(SpaceReader&&) noexcept = default;
SpaceReader::~SpaceReader() = default;

std::size_t SpaceReader::namespace_count() const
{
    return tables_->namespaces.size();
}

std::string_view SpaceReader::namespace_uri(std::uint16_t index) const
{
    return index < namespace_count() ? tables_->namespaces.uri(index) : std::string_view{};
}

std::optional<std::uint16_t> SpaceReader::namespace_index(std::string_view uri) const
{
    return tables_->namespaces.find(uri);
}

NodeIndex SpaceReader::find(const NodeId& id) const
{
    return tables_->find(id);
}

NodeIndex SpaceReader::find(std::uint32_t namespace0_id) const
{
    return tables_->find(NodeId{0, namespace0_id});
}

void SpaceReader::fetch_nodes(std::span<const NodeId* const> ids) const
{
    tables_->fetch_nodes(ids);
}

void SpaceReader::find_nodes(std::span<const NodeId* const> ids, std::span<NodeIndex> found) const
{
    tables_->find_nodes(ids, found);
}

NodeHandle SpaceReader::handle(NodeIndex node) const
{
    return {node, tables_->is_constant(node) ? 0 : tables_->record(node).generation};
}

NodeIndex SpaceReader::resolve(NodeHandle handle) const
{
    return exists(handle.index) && this->handle(handle.index) == handle ? handle.index : no_node;
}

void SpaceReader::resolve_nodes(std::span<const NodeHandle> handles,
                                std::span<NodeIndex> found) const
{
    for (std::size_t first = 0; first < handles.size(); first += fetched_together) {
        const auto group =
            handles.subspan(first, std::min(fetched_together, handles.size() - first));
        tables_->fetch_nodes(group);
        for (std::size_t i = 0; i < group.size(); ++i) {
            found[first + i] = resolve(group[i]);
        }
    }
}

bool SpaceReader::exists(NodeIndex node) const
{
    if (tables_->is_constant(node)) {
        return true;
    }
    return detail::number(node) - tables_->constant_count < tables_->record_count &&
           !tables_->record(node).is_free();
}

bool SpaceReader::is_constant(NodeIndex node) const
{
    return tables_->is_constant(node);
}

std::size_t SpaceReader::node_count() const
{
    return std::size_t{tables_->constant_count} + tables_->record_count - tables_->free_count;
}

void SpaceReader::for_each(FunctionRef<void(NodeIndex)> visit) const
{
    for (std::uint32_t i = 0; i < tables_->constant_count + tables_->record_count; ++i) {
        if (exists(NodeIndex{i})) {
            visit(NodeIndex{i});
        }
    }
}

NodeClass SpaceReader::node_class(NodeIndex node) const
{
    return tables_->is_constant(node) ? NodeClass{tables_->constant(node).node_class}
                                      : tables_->record(node).node_class();
}

NodeId SpaceReader::node_id(NodeIndex node) const
{
    return tables_->is_constant(node) ? NodeId{0, tables_->constant(node).id.value}
                                      : tables_->record(node).node_id();
}

QualifiedName SpaceReader::browse_name(NodeIndex node) const
{
    if (tables_->is_constant(node)) {
        const StaticNode& constant = tables_->constant(node);
        return {constant.browse_namespace, String::borrow(tables_->text(constant.browse_name))};
    }
    const detail::NodeRecord& record = tables_->record(node);
    return {record.browse_namespace, String::borrow(record.name(tables_->links(node)))};
}

} // namespace busbar::model
