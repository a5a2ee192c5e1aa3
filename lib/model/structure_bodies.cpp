#include "structure_bodies.hpp"

namespace busbar::model::detail {

void StructureBodies::map(ExtensionObject& object, std::span<const std::uint16_t> map) const
{
    auto structure = binary::decode_dynamic(object, types_.of(space_));
    if (!structure) {
        return;
    }
    this->map(*structure, map);
    if (auto mapped = binary::to_extension_object(*structure)) {
        object = std::move(*mapped);
    }
}

/// The content of a field still fits after mapping, so that setting it does not fail.
void StructureBodies::map(binary::DynamicValue& structure, std::span<const std::uint16_t> map) const
{
    const auto replace = [&](std::size_t field, const auto& held, auto map_content) {
        auto content = held;
        map_content(content);
        static_cast<void>(structure.set(field, std::move(content)));
    };
    for (std::size_t i = 0; i < structure.type().fields.size(); ++i) {
        if (const auto* const value = structure.value(i)) {
            replace(i, *value, [&](Variant& content) { map_namespaces(content, map, this); });
        } else if (const auto* const inner = structure.structure(i)) {
            replace(i, *inner, [&](binary::DynamicValue& content) { this->map(content, map); });
        } else if (const auto* const all = structure.structures(i)) {
            replace(i, *all, [&](binary::DynamicArray& content) {
                for (binary::DynamicValue& each : content.values) {
                    this->map(each, map);
                }
            });
        }
    }
}

} // namespace busbar::model::detail
