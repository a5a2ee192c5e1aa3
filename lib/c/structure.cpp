#include "structure.hpp"

#include <cstring>
#include <utility>
#include <vector>

#include <busbar/model/data_types.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "server.hpp"

namespace busbar::c {

namespace {

/// Returns an image of one structure in memory of its own, so that a program's need not be aligned.
struct OneStructure {
    explicit OneStructure(std::shared_ptr<const server::ImageStructure> form)
    {
        server::ImageVariable variable;
        variable.type = BuiltInType::ExtensionObject;
        variable.structure = std::move(form);
        static_cast<void>(layout.add(variable)); // as it did when the structure was made
        memory.emplace(layout);
    }
    [[nodiscard]] std::byte* bytes() { return memory->bytes(layout[0]); }

    server::ImageLayout layout;
    std::optional<server::ImageMemory> memory;
};

/// Returns the DataType of a field.
NodeId data_type_of(const model::AddressSpace& space, const busbar_field& field)
{
    if (field.structure == nullptr) {
        return NodeId{0, std::uint32_t{field.type}}; // Part 6, 5.1.2
    }
    const auto value = ExtensionObject::from_binary(field.structure->form->encoding_id(),
                                                    ByteString{std::span<const std::byte>{}});
    const model::NodeIndex type = space.type_of_value(Variant{value});
    return type != model::no_node ? space.node_id(type) : NodeId{};
}

Result<StructureDefinition> definition_of(const model::AddressSpace& space,
                                          std::span<const busbar_field> fields)
{
    StructureDefinition definition;
    for (const busbar_field& each : fields) {
        if (each.name == nullptr || *each.name == '\0') {
            return fail(status::Bad_InvalidArgument);
        }
        StructureField field;
        field.name = each.name;
        field.data_type = data_type_of(space, each);
        field.value_rank = each.count == 0 ? -1 : 1;
        if (each.count != 0) {
            field.array_dimensions = {each.count};
        }
        field.max_string_length = each.capacity;
        definition.fields.push_back(std::move(field));
    }
    return definition;
}

StatusCode add_type(busbar_server& server, const busbar_node& from,
                    std::span<const busbar_field> fields, busbar_structure*& structure)
{
    model::AddressSpace& space = server.server->address_space();
    std::vector<server::ImageVariable> members;
    for (const busbar_field& field : fields) {
        auto member = image_variable_of(field);
        if (!member) {
            return member.error();
        }
        members.push_back(*std::move(member));
    }
    busbar_node in_types = from;
    in_types.parent = nullptr;
    const auto node = new_node_of(space, in_types, id::Structure);
    auto definition = definition_of(space, fields);
    if (!node || !definition) {
        return node ? definition.error() : node.error();
    }
    do { // each is given once
        definition->default_encoding_id = space.free_id(from.namespace_index);
    } while (definition->default_encoding_id == node->id);
    // Types cannot be removed: the form is made before.
    auto form = server::ImageStructure::create(definition->default_encoding_id, members);
    if (!form) {
        return form.error();
    }
    auto made = std::make_shared<busbar_structure>();
    made->form = *std::move(form);
    server.owned.push_back(made);
    const auto added = model::add_structure_type(space, *node, *std::move(definition));
    if (!added) {
        server.owned.pop_back();
        return added.error();
    }
    structure = made.get();
    return status::Good;
}

} // namespace

Result<server::ImageVariable> image_variable_of(const busbar_field& field)
{
    server::ImageVariable variable;
    variable.type = static_cast<BuiltInType>(field.type);
    if (field.type > BUSBAR_EXTENSION_OBJECT ||
        (field.type == BUSBAR_EXTENSION_OBJECT) != (field.structure != nullptr)) {
        return fail(status::Bad_DataTypeIdUnknown);
    }
    if (field.count != 0) {
        variable.dimensions = {field.count};
    }
    variable.capacity = field.capacity;
    if (field.structure != nullptr) {
        variable.structure = field.structure->form;
    }
    return variable;
}

} // namespace busbar::c

using namespace busbar;

busbar_status busbar_server_add_structure(busbar_server* server, const busbar_node* node,
                                          const busbar_field* fields, size_t count,
                                          busbar_structure** structure)
{
    return c::change(server, [&]() -> StatusCode {
        if (node == nullptr || fields == nullptr || structure == nullptr ||
            count > server::ImageStructure::max_members) {
            return status::Bad_InvalidArgument;
        }
        *structure = nullptr;
        if (node->namespace_index >= server->server->address_space().namespace_count()) {
            return status::Bad_NodeIdInvalid;
        }
        return c::add_type(*server, *node, {fields, count}, *structure);
    });
}

size_t busbar_structure_size(const busbar_structure* structure)
{
    return structure != nullptr ? structure->form->size() : 0;
}

busbar_status busbar_structure_pack(busbar_structure* structure, const void* memory, size_t size,
                                    busbar_value* value)
{
    return c::run_guarded(nullptr, [&]() -> StatusCode {
        if (structure == nullptr || memory == nullptr || value == nullptr) {
            return status::Bad_InvalidArgument;
        }
        if (size != structure->form->size()) {
            return status::Bad_OutOfRange;
        }
        c::OneStructure one{structure->form};
        std::memcpy(one.bytes(), memory, size);
        structure->packed = one.memory->load(0);
        structure->scratch.clear();
        return c::to_c(structure->packed, structure->scratch, *value);
    });
}

busbar_status busbar_structure_unpack(busbar_structure* structure, const busbar_value* value,
                                      void* memory, size_t size)
{
    return c::run_guarded(nullptr, [&]() -> StatusCode {
        if (structure == nullptr || value == nullptr || memory == nullptr) {
            return status::Bad_InvalidArgument;
        }
        if (size != structure->form->size()) {
            return status::Bad_OutOfRange;
        }
        const auto from = c::to_variant(*value);
        if (!from) {
            return from.error();
        }
        c::OneStructure one{structure->form};
        const StatusCode stored = one.memory->store(0, *from);
        if (stored.is_good()) {
            std::memcpy(memory, one.bytes(), size);
        }
        return stored;
    });
}
