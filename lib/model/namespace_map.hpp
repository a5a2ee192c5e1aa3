#pragma once

#include <cstdint>
#include <span>

#include <busbar/core/types.hpp>

namespace busbar::model::detail {

/// Looks into the bodies of structures that have no generated type.
class BodyMap {
public:
    BodyMap() = default;
    BodyMap(const BodyMap&) = delete;
    BodyMap& operator=(const BodyMap&) = delete;

    /// `object` has a binary body, and the encoding's id is replaced already.
    virtual void map(ExtensionObject& object, std::span<const std::uint16_t> map) const = 0;

protected:
    ~BodyMap() = default;
};

/// Replaces every namespace index of a value by `map[index]`; an index past the map stays.
///
/// Looks into Variants, DataValues and structures: Argument, RolePermissionType and
/// StructureDefinition always, others by `bodies`; without it their bodies stay as they are.
void map_namespaces(Variant& value, std::span<const std::uint16_t> map,
                    const BodyMap* bodies = nullptr);

} // namespace busbar::model::detail
