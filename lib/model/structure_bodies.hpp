#pragma once

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/model/data_types.hpp>

#include "namespace_map.hpp"

namespace busbar::model::detail {

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
