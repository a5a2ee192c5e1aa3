#include <busbar/model/address_space.hpp>

#include "core/utf8.hpp"
#include "tables.hpp"

namespace busbar::model {

AddressSpace::AddressSpace(const StaticNodes& static_nodes)
    : SpaceReader{std::make_unique<detail::Tables>(static_nodes)}
{
}

AddressSpace::AddressSpace(AddressSpace&&) noexcept = default;
AddressSpace& AddressSpace::operator=(AddressSpace&&) noexcept = default;
AddressSpace::~AddressSpace() = default;

Result<std::uint16_t> AddressSpace::add_namespace(std::string_view uri)
{
    if (const auto known = namespace_index(uri)) {
        return *known;
    }
    if (!busbar::detail::is_valid_text(uri)) {
        return fail(status::Bad_EncodingError);
    }
    if (namespace_count() > UINT16_MAX) {
        return fail(status::Bad_TooManyOperations);
    }
    tables_->namespaces.add(uri);
    return static_cast<std::uint16_t>(namespace_count() - 1);
}

NodeId AddressSpace::free_id(std::uint16_t namespace_index)
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
