#pragma once

#include <cstdint>

#include <busbar/core/variant.hpp>

namespace busbar::controller::detail {

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
