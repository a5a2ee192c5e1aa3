#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <busbar/model/address_space.hpp>

#include "session_fields.hpp"

namespace busbar::server::detail {

/// What a handle of a Variable of the diagnostics leads to. It is the number of the session or the
/// Subscription, the section and the field of that; field 0 is all of it.
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

/// A Variable of the diagnostics with one Variable for each field that its type has.
struct PartNodes {
    Section section;
    std::string_view name;
    /// Whose DataType and ValueRank it has. There is no such part where this is no_node.
    model::NodeIndex declaration;
    std::uint32_t type;
    std::span<const FieldName> fields;
    /// Who may see it; null for everybody.
    const model::NodeAccess* access{nullptr};
    /// Of its name; its fields' are of OPC UA.
    std::uint16_t name_space{0};
};

/// Adds it below `parent`, with a NodeId of `name_space`, and without its fields, which most often
/// nobody looks for; no_node if it could not be added.
model::NodeIndex add_part(model::AddressSpace& space, model::NodeIndex parent,
                          std::uint16_t name_space, std::uint32_t number, const PartNodes& part);
/// Adds those of its fields that are not there; how many there were.
std::size_t add_fields(model::AddressSpace& space, model::NodeIndex made, std::uint16_t name_space,
                       std::uint32_t number, const PartNodes& part);

} // namespace busbar::server::detail
