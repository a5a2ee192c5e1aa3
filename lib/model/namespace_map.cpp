#include "namespace_map.hpp"

#include <busbar/binary/codec.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::model::detail {

namespace {

constexpr std::uint32_t argument_encoding = id::Argument_Encoding_DefaultBinary;
constexpr std::uint32_t role_permission_encoding = id::RolePermissionType_Encoding_DefaultBinary;
constexpr std::uint32_t structure_definition_encoding =
    id::StructureDefinition_Encoding_DefaultBinary;

/// The overloads call each other: a Variant may hold any of the others.
class NamespaceMap {
public:
    NamespaceMap(std::span<const std::uint16_t> map, const BodyMap* bodies)
        : map_{map}, bodies_{bodies}
    {
    }

    void apply(Variant& value) const
    {
        apply_to<NodeId>(value);
        apply_to<ExpandedNodeId>(value);
        apply_to<QualifiedName>(value);
        apply_to<ExtensionObject>(value);
        apply_to<DataValue>(value);
        apply_to<Variant>(value);
    }

private:
    [[nodiscard]] std::uint16_t at(std::uint16_t index) const
    {
        return index < map_.size() ? map_[index] : index;
    }
    void apply(NodeId& id) const { id.set_namespace_index(at(id.namespace_index())); }
    void apply(ExpandedNodeId& id) const
    {
        if (id.is_local()) {
            apply(id.node_id);
        }
    }
    void apply(QualifiedName& name) const { name.namespace_index = at(name.namespace_index); }
    void apply(DataValue& value) const { apply(value.value); }
    void apply(ExtensionObject& object) const;
    void apply(Argument& argument) const { apply(argument.data_type); }
    void apply(RolePermissionType& permission) const { apply(permission.role_id); }
    void apply(StructureDefinition& definition) const
    {
        apply(definition.default_encoding_id);
        apply(definition.base_data_type);
        for (StructureField& field : definition.fields) {
            apply(field.data_type);
        }
    }
    /// Returns the structure in a binary body, with its indices replaced.
    template <typename T>
    void apply_inside(ExtensionObject& object) const
    {
        auto structure = binary::from_bytes<T>(object.binary().span());
        if (!structure) {
            return;
        }
        apply(*structure);
        if (const auto bytes = binary::to_bytes(*structure)) {
            object =
                ExtensionObject::from_binary(object.encoding_id(), ByteString{std::span{*bytes}});
        }
    }
    template <typename T>
    void apply_to(Variant& value) const
    {
        if constexpr (!std::is_same_v<T, Variant>) {
            if (auto* const scalar = value.get_if<T>()) {
                apply(*scalar);
            }
        }
        if (auto* const array = value.array_if<T>()) {
            for (T& element : *array) {
                apply(element);
            }
        }
    }

    std::span<const std::uint16_t> map_;
    const BodyMap* bodies_;
};

void NamespaceMap::apply(ExtensionObject& object) const
{
    if (const auto* const permission = object.get_if<RolePermissionType>()) {
        RolePermissionType mapped = *permission;
        apply(mapped);
        object = ExtensionObject::from(std::move(mapped));
        return;
    }
    NodeId id = object.encoding_id();
    if (object.body() == ExtensionObject::Body::Binary && id.is(argument_encoding)) {
        apply_inside<Argument>(object);
        return;
    }
    if (object.body() == ExtensionObject::Body::Binary && id.is(role_permission_encoding)) {
        apply_inside<RolePermissionType>(object);
        return;
    }
    if (object.body() == ExtensionObject::Body::Binary && id.is(structure_definition_encoding)) {
        apply_inside<StructureDefinition>(object);
        return;
    }
    apply(id);
    if (object.body() == ExtensionObject::Body::Binary) {
        object = ExtensionObject::from_binary(std::move(id), object.binary());
        if (bodies_ != nullptr) {
            bodies_->map(object, map_);
        }
    } else if (object.body() == ExtensionObject::Body::Xml) {
        object = ExtensionObject::from_xml(std::move(id), object.xml());
    } else if (object.body() == ExtensionObject::Body::None) {
        object = ExtensionObject::from_id(std::move(id));
    }
}

} // namespace

void map_namespaces(Variant& value, std::span<const std::uint16_t> map, const BodyMap* bodies)
{
    NamespaceMap{map, bodies}.apply(value);
}

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
