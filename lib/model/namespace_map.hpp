#pragma once

#include <cstdint>
#include <span>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/core/types.hpp>
#include <busbar/model/data_types.hpp>

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

/// Reads bodies by the DataTypeDefinitions of an address space, whose NodeIds are those of the
/// mapped values. They are compiled for the first body only; a body whose definition is unknown
/// stays unchanged.
class StructureBodies final : public BodyMap {
public:
    /// `space` must outlive this.
    explicit StructureBodies(const SpaceReader& space) : space_{space} {}

    void map(ExtensionObject& object, std::span<const std::uint16_t> map) const override;

private:
    void map(binary::DynamicValue& structure, std::span<const std::uint16_t> map) const;

    const SpaceReader& space_;
    mutable DataTypes types_;
};

} // namespace busbar::model::detail
