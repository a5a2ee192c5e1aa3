#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include <busbar/binary/type_registry.hpp>

namespace busbar::server::detail {

/// Returns structures of namespace 0 in the form for a TypeRegistry.
template <typename... T>
[[nodiscard]] binary::TypeRegistry::Table type_table()
{
    using Types = std::array<const StructureType*, sizeof...(T)>;
    static constexpr Types types = [] {
        std::array by_id{std::pair{T::binary_encoding_id, &T::type}...};
        std::sort(by_id.begin(), by_id.end(),
                  [](const auto& a, const auto& b) { return a.first < b.first; });
        Types sorted{};
        std::transform(by_id.begin(), by_id.end(), sorted.begin(),
                       [](const auto& type) { return type.second; });
        return sorted;
    }();
    return types;
}

} // namespace busbar::server::detail
