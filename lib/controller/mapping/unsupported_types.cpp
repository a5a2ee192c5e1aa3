#include "unsupported_types.hpp"

#include <algorithm>

#include <busbar/types/ids.hpp>

namespace busbar::controller::detail {

namespace {

using model::NodeIndex;

constexpr std::uint32_t unsupported_ids[] = {
    id::ConnectionTransportDataType,
    id::DataSetReaderDataType,
    id::DataSetReaderMessageDataType,
    id::DataSetWriterDataType,
    id::DataSetWriterMessageDataType,
    id::DataTypeSchemaHeader,
    id::FieldMetaData,
    id::PublishedDataSetDataType,
    id::PubSubConfigurationDataType,
    id::PubSubConnectionDataType,
    id::PubSubGroupDataType,
    id::RolePermissionType,
    id::SubscribedDataSetDataType,
    id::WriterGroupMessageDataType,
    id::ProgramDiagnosticType,
    id::DataSetReaderMessageType,
    id::DataSetReaderType,
    id::DataSetWriterMessageType,
    id::DataSetWriterType,
    id::PublishedDataSetType,
    id::WriterGroupMessageType,
};

} // namespace

UnsupportedTypes::UnsupportedTypes(const model::SpaceReader& space) : space_{space}
{
    for (const std::uint32_t each : unsupported_ids) {
        if (const NodeIndex type = space.find(each); type != model::no_node) {
            types_.push_back(type);
        }
    }
    std::sort(types_.begin(), types_.end());
}

NodeIndex UnsupportedTypes::listed(NodeIndex type) const
{
    for (NodeIndex each = type; each != model::no_node; each = space_.supertype(each)) {
        if (std::binary_search(types_.begin(), types_.end(), each)) {
            return type;
        }
    }
    return model::no_node;
}

NodeIndex UnsupportedTypes::of(NodeIndex node) const
{
    const NodeClass node_class = space_.node_class(node);
    const bool is_variable = node_class == NodeClass::Variable;
    if (space_.node_id(node).namespace_index() == 0 ||
        !(is_variable || node_class == NodeClass::Object)) {
        return model::no_node;
    }
    const NodeIndex type = listed(space_.type_definition(node));
    if (type != model::no_node || !is_variable) {
        return type;
    }
    return listed(space_.find(space_.data_type_id(node)));
}

} // namespace busbar::controller::detail
