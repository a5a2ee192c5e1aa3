#include "node_values.hpp"

#include <busbar/binary/codec.hpp>
#include <model/nodeset/data_types.hpp>
#include <model/nodeset/value_reader.hpp>

namespace busbar::generator {

namespace {

Expected<std::string, Failure> encoded(const nodeset::Document& document, const nodeset::Node& node,
                                       const Variant& value)
{
    const auto bytes = binary::to_bytes(value);
    if (!bytes) {
        return Unexpected{text(document.problem(node, "a value cannot be encoded"))};
    }
    return std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

} // namespace

Expected<std::string, Failure> NodeValues::value(const nodeset::Node& node) const
{
    if (!node.value) {
        return std::string{};
    }
    std::size_t fields_left = document_.limits().max_value_fields;
    nodeset::XmlValueReader reader{types_, document_.files()[node.file].namespaces, fields_left};
    const Variant value = reader.variant(*node.value);
    if (!reader.error().empty()) {
        return Unexpected{text(document_.problem(node, reader.error(), reader.error_line()))};
    }
    return encoded(document_, node, value);
}

std::string NodeValues::permissions(const nodeset::Node& node)
{
    constexpr std::uint32_t role_permission_encoding =
        busbar::detail::basic_id::RolePermissionType_Encoding_DefaultBinary;
    if (!node.role_permissions) {
        return {};
    }
    Array<ExtensionObject> permissions;
    permissions.clear(); // not null
    for (const model::NodeSetPermission& each : *node.role_permissions) {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        encode(writer, each.role);
        encode(writer, each.permissions);
        const auto body = sink.take(writer.written());
        permissions.push_back(ExtensionObject::from_binary(NodeId{0, role_permission_encoding},
                                                           ByteString{std::span{body}}));
    }
    const auto bytes = binary::to_bytes(Variant{std::move(permissions)});
    return bytes ? std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}
                 : std::string{};
}

Expected<std::string, Failure> NodeValues::definition(const nodeset::Node& node) const
{
    const nodeset::DataType* const type = types_.find(node.id);
    ExtensionObject definition =
        type == nullptr ? ExtensionObject{} : nodeset::definition_of(types_, *type);
    return definition.is_null() ? std::string{}
                                : encoded(document_, node, Variant{std::move(definition)});
}

} // namespace busbar::generator
