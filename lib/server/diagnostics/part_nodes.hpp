#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <busbar/model/address_space.hpp>

#include "describe.hpp"

namespace busbar::server::detail {

/// The meaning of a handle of a Variable of the diagnostics: the number of the session or the
/// Subscription, the section and the field; field 0 is the whole structure.
enum class Section : std::uint8_t {
    Session,
    Security,
    /// The array of a session's Subscriptions.
    SubscriptionTable,
    Subscription
};

[[nodiscard]] constexpr std::uint64_t handle_of(std::uint32_t number, Section section,
                                                std::size_t field)
{
    return std::uint64_t{number} << 16U | static_cast<std::uint64_t>(section) << 8U | field;
}

[[nodiscard]] constexpr std::uint32_t number_of(std::uint64_t handle)
{
    return static_cast<std::uint32_t>(handle >> 16U);
}

[[nodiscard]] constexpr Section section_of(std::uint64_t handle)
{
    return static_cast<Section>(handle >> 8U & 0xFFU);
}

[[nodiscard]] constexpr std::size_t field_of(std::uint64_t handle)
{
    return handle & 0xFFU;
}

/// A Variable of the diagnostics with one Variable for each field of its type.
struct PartNodes {
    Section section;
    std::string_view name;
    /// The source of its DataType and ValueRank. If it is no_node, there is no such part.
    model::NodeIndex declaration;
    std::uint32_t type;
    std::span<const FieldName> fields;
    /// Its access rules; null for everybody.
    const model::NodeAccess* access{nullptr};
    /// Namespace of its name; its fields' names belong to OPC UA.
    std::uint16_t name_space{0};
};

/// Adds it below `parent`, with a NodeId in `name_space`, and without its fields, which are rarely
/// read; no_node if it could not be added.
model::NodeIndex add_part(model::AddressSpace& space, model::NodeIndex parent,
                          std::uint16_t name_space, std::uint32_t number, const PartNodes& part);
/// Adds the missing fields; returns their number.
std::size_t add_fields(model::AddressSpace& space, model::NodeIndex made, std::uint16_t name_space,
                       std::uint32_t number, const PartNodes& part);

} // namespace busbar::server::detail
