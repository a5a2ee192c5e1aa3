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

/// Adds it below `parent`, with NodeIds of `name_space`; no_node if it could not be added.
model::NodeIndex add_part(model::AddressSpace& space, model::NodeIndex parent,
                          std::uint16_t name_space, std::uint32_t number, const PartNodes& part);

} // namespace busbar::server::detail
