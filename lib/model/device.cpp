#include <busbar/model/device.hpp>

#include <utility>

#include <busbar/types/ids.hpp>

#include "instantiation.hpp"

namespace busbar::model {

namespace {

/// A Property of DI and its value.
struct NameplateEntry {
    const char* name;
    Variant value;
    bool is_optional;
};

std::vector<NameplateEntry> entries_of(const Nameplate& nameplate)
{
    std::vector<NameplateEntry> entries;
    entries.push_back({"Manufacturer", nameplate.manufacturer, false});
    entries.push_back({"Model", nameplate.model, false});
    entries.push_back({"HardwareRevision", nameplate.hardware_revision, false});
    entries.push_back({"SoftwareRevision", nameplate.software_revision, false});
    entries.push_back({"DeviceRevision", nameplate.device_revision, false});
    entries.push_back({"DeviceManual", nameplate.device_manual, false});
    entries.push_back({"SerialNumber", nameplate.serial_number, false});
    entries.push_back({"RevisionCounter", nameplate.revision_counter, false});
    const std::pair<const char*, const String&> optional[] = {
        {"ManufacturerUri", nameplate.manufacturer_uri},
        {"ProductCode", nameplate.product_code},
        {"ProductInstanceUri", nameplate.product_instance_uri},
        {"DeviceClass", nameplate.device_class}};
    for (const auto& [name, text] : optional) {
        if (!text.is_null()) {
            entries.push_back({name, text, true});
        }
    }
    return entries;
}

} // namespace

NodeIndex find_di(const SpaceReader& space, std::uint32_t number)
{
    const auto index = space.namespace_index(di_uri);
    return index ? space.find(NodeId{*index, number}) : no_node;
}

Result<NodeIndex> add_device(AddressSpace& space, NewNode node, NodeIndex type,
                             const Nameplate& nameplate, InstanceOptions options)
{
    if (!space.exists(type) || !space.is_subtype_of(type, find_di(space, di_id::DeviceType))) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    if (node.parent == no_node) {
        node.parent = find_di(space, di_id::DeviceSet);
    }
    const std::vector<NameplateEntry> entries = entries_of(nameplate);
    for (const NameplateEntry& entry : entries) {
        if (entry.is_optional) {
            options.optional.emplace_back(entry.name);
        }
    }
    const auto device = instantiate(space, node, type, options);
    if (!device) {
        return device;
    }
    const std::uint16_t di = *space.namespace_index(di_uri);
    for (const NameplateEntry& entry : entries) {
        const NodeIndex property =
            detail::child_of(space, *device, QualifiedName{di, String{entry.name}});
        const auto set = property == no_node ? Result<void>{fail(status::Bad_NotFound)}
                                             : space.set_value(property, entry.value);
        if (!set) {
            static_cast<void>(space.remove(*device));
            return fail(set.error());
        }
    }
    return device;
}

Result<NodeIndex> add_functional_group(AddressSpace& space, NodeIndex parent,
                                       const QualifiedName& name)
{
    const NodeIndex type = find_di(space, di_id::FunctionalGroupType);
    if (type == no_node || !space.exists(parent)) {
        return fail(type == no_node ? status::Bad_TypeDefinitionInvalid
                                    : status::Bad_ParentNodeIdInvalid);
    }
    return instantiate(space, detail::child_node(space, parent, name), type);
}

Result<NodeIndex> add_parameter(AddressSpace& space, NodeIndex device, NodeIndex group,
                                const QualifiedName& name, const NewVariable& variable)
{
    if (!space.exists(device) || !space.is_subtype_of(space.type_definition(device),
                                                      find_di(space, di_id::TopologyElementType))) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    const auto set = detail::optional_member(space, device, "ParameterSet");
    if (!set) {
        return set;
    }
    const auto parameter = space.add_variable(detail::child_node(space, *set, name), variable);
    if (parameter && group != no_node) {
        const auto organized = space.add_reference(group, NodeId{0, id::Organizes}, *parameter);
        if (!organized) {
            static_cast<void>(space.remove(*parameter));
            return fail(organized.error());
        }
    }
    return parameter;
}

} // namespace busbar::model
