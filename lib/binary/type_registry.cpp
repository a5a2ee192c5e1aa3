#include <busbar/binary/type_registry.hpp>

#include <algorithm>

namespace busbar::binary {

namespace {

/// Numeric ids come before strings.
bool is_before(const StructureType* type, const NodeId& id)
{
    const StaticId& encoding = type->binary_encoding_id;
    if (encoding.string.empty()) {
        return !id.is_numeric() || encoding.numeric < id.numeric();
    }
    return !id.is_numeric() && encoding.string < id.string().view();
}

bool is_same(const StructureType* type, const NodeId& id)
{
    const StaticId& encoding = type->binary_encoding_id;
    return encoding.string.empty() ? id.is_numeric() && encoding.numeric == id.numeric()
                                   : !id.is_numeric() && encoding.string == id.string().view();
}

} // namespace

void TypeRegistry::add(std::uint16_t namespace_index, Table table)
{
    entries_.push_back({namespace_index, table});
}

const StructureType* TypeRegistry::find(const NodeId& encoding_id) const
{
    if (encoding_id.id_type() != IdType::Numeric && encoding_id.id_type() != IdType::String) {
        return nullptr;
    }
    for (const Entry& entry : entries_) {
        if (entry.namespace_index != encoding_id.namespace_index()) {
            continue;
        }
        const auto found =
            std::lower_bound(entry.table.begin(), entry.table.end(), encoding_id, is_before);
        if (found != entry.table.end() && is_same(*found, encoding_id)) {
            return *found;
        }
    }
    return nullptr;
}

} // namespace busbar::binary
