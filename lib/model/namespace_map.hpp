#pragma once

#include <cstdint>
#include <span>

#include <busbar/core/types.hpp>

namespace busbar::model::detail {

/// Maps the bodies of structures that have no generated type.
class BodyMap {
public:
    BodyMap() = default;
    BodyMap(const BodyMap&) = delete;
    BodyMap& operator=(const BodyMap&) = delete;

    /// `object` has a binary body, and the encoding's id has been replaced already.
    virtual void map(ExtensionObject& object, std::span<const std::uint16_t> map) const = 0;

protected:
    ~BodyMap() = default;
};

/// Replaces every namespace index of a value by `map[index]`; an index past the map stays.
///
/// Maps Variants, DataValues and structures: Argument, RolePermissionType and StructureDefinition
/// always, others by `bodies`; without it their bodies stay unchanged.
void map_namespaces(Variant& value, std::span<const std::uint16_t> map,
                    const BodyMap* bodies = nullptr);

} // namespace busbar::model::detail
