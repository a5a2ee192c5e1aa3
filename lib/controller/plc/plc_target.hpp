#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>

#include <busbar/server/image_memory.hpp>

namespace busbar::controller::detail {

/// The variable, or member of a structure, that a program or a watch works on, in the memory of its
/// task. Valid as long as that memory.
struct PlcTarget {
    BuiltInType type{BuiltInType::Null};
    std::uint32_t elements{1};
    /// Distance between elements in bytes.
    std::uint32_t stride{0};
    std::byte* bytes{nullptr};

    PlcTarget() = default;
    /// Makes the target of the `place` at `at`.
    PlcTarget(const server::ImagePlace& place, std::byte* at)
        : type{place.type}, elements{place.elements}, stride{place.stride}, bytes{at}
    {
    }

    /// Returns the values; T must match the type.
    template <server::ImageNumber T>
    [[nodiscard]] std::span<T> values() const
    {
        return {std::launder(static_cast<T*>(static_cast<void*>(bytes))), elements};
    }
    [[nodiscard]] std::span<std::byte> all() const
    {
        return {bytes, std::size_t{elements} * stride};
    }
};

} // namespace busbar::controller::detail
