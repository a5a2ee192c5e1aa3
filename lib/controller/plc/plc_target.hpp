#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>

#include <busbar/core/variant.hpp>
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

template <typename T>
struct Tag {
    using type = T;
};

/// Calls `visit(Tag<T>)` for the type of a number; returns null for other types.
template <typename Visit>
auto visit_number(BuiltInType type, Visit&& visit) -> decltype(visit(Tag<double>{}))
{
    // clang-format off
    switch (type) {
    case BuiltInType::SByte: return visit(Tag<std::int8_t>{});
    case BuiltInType::Byte: return visit(Tag<std::uint8_t>{});
    case BuiltInType::Int16: return visit(Tag<std::int16_t>{});
    case BuiltInType::UInt16: return visit(Tag<std::uint16_t>{});
    case BuiltInType::Int32: return visit(Tag<std::int32_t>{});
    case BuiltInType::UInt32: return visit(Tag<std::uint32_t>{});
    case BuiltInType::Int64: return visit(Tag<std::int64_t>{});
    case BuiltInType::UInt64: return visit(Tag<std::uint64_t>{});
    case BuiltInType::Float: return visit(Tag<float>{});
    case BuiltInType::Double: return visit(Tag<double>{});
    default: return nullptr;
    }
    // clang-format on
}

} // namespace busbar::controller::detail
