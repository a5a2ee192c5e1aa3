#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/extension_object.hpp>

namespace busbar::binary {

/// The structures that a decoder knows, by namespace index and encoding id.
///
/// Tables are constant data sorted by binary_encoding_id (numeric ones first, by number, then
/// strings) and must outlive the registry. Filled once, then read from any thread.
class BUSBAR_API TypeRegistry {
public:
    using Table = std::span<const StructureType* const>;

    TypeRegistry() = default;
    /// A registry with `namespace0` as the table of namespace 0.
    explicit TypeRegistry(Table namespace0) { add(0, namespace0); }

    /// Adds the types of one namespace; several tables may share an index.
    void add(std::uint16_t namespace_index, Table table);
    /// The type whose binary encoding is `encoding_id`, or null.
    [[nodiscard]] const StructureType* find(const NodeId& encoding_id) const;

private:
    struct Entry {
        std::uint16_t namespace_index;
        Table table;
    };
    std::vector<Entry> entries_;
};

} // namespace busbar::binary
