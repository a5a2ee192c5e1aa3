#include "structures.hpp"

namespace busbar::test {

namespace {

using Types = std::map<std::string, NamedType>;

void add_built_in_types(Types& types)
{
    types = {
        {"Boolean", named_type<bool>()},
        {"SByte", named_type<std::int8_t>()},
        {"Byte", named_type<std::uint8_t>()},
        {"Int16", named_type<std::int16_t>()},
        {"UInt16", named_type<std::uint16_t>()},
        {"Int32", named_type<std::int32_t>()},
        {"UInt32", named_type<std::uint32_t>()},
        {"Int64", named_type<std::int64_t>()},
        {"UInt64", named_type<std::uint64_t>()},
        {"Float", named_type<float>()},
        {"Double", named_type<double>()},
        {"String", named_type<String>()},
        {"DateTime", named_type<DateTime>()},
        {"Guid", named_type<Guid>()},
        {"ByteString", named_type<ByteString>()},
        {"XmlElement", named_type<XmlElement>()},
        {"NodeId", named_type<NodeId>()},
        {"ExpandedNodeId", named_type<ExpandedNodeId>()},
        {"StatusCode", named_type<StatusCode>()},
        {"QualifiedName", named_type<QualifiedName>()},
        {"LocalizedText", named_type<LocalizedText>()},
        {"ExtensionObject", named_type<ExtensionObject>()},
        {"DataValue", named_type<DataValue>()},
        {"Variant", named_type<Variant>()},
        {"DiagnosticInfo", named_type<DiagnosticInfo>()},
    };
}

template <typename... Structures>
void add_structures(Types& types)
{
    (types.emplace(std::string{Structures::type.name}, named_type<Structures>()), ...);
}

Types make_types()
{
    Types types;
    add_built_in_types(types);
    add_structures<ActivateSessionRequest, ActivateSessionResponse, AggregateFilter,
                   AnonymousIdentityToken, ApplicationDescription, Argument, AttributeOperand,
                   AxisInformation, BrowseRequest, BrowseResponse, CallRequest, CallResponse,
                   CloseSecureChannelRequest, CloseSessionRequest, ComplexNumberType, ContentFilter,
                   CreateMonitoredItemsRequest, CreateMonitoredItemsResponse, CreateSessionRequest,
                   CreateSessionResponse, CreateSubscriptionRequest, DataChangeFilter,
                   DataChangeNotification, DoubleComplexNumberType, EUInformation, ElementOperand,
                   EndpointDescription>(types);
    add_structures<EnumDefinition, EnumValueType, EventFilter, EventNotificationList,
                   FindServersResponse, GetEndpointsRequest, GetEndpointsResponse, HistoryData,
                   HistoryReadRequest, LiteralOperand, LogRecord, OpenSecureChannelRequest,
                   OpenSecureChannelResponse, PublishRequest, PublishResponse, Range,
                   ReadRawModifiedDetails, ReadRequest, ReadResponse, ReadValueId, RequestHeader,
                   ResponseHeader, RolePermissionType, ServerEndpointDataType>(types);
    add_structures<ServerStatusDataType, ServiceFault, SignatureData, SimpleAttributeOperand,
                   StatusChangeNotification, StructureDefinition, TimeZoneDataType,
                   TranslateBrowsePathsToNodeIdsRequest, UserNameIdentityToken, UserTokenPolicy,
                   WriteRequest, WriteResponse, X509IdentityToken, XVType>(types);
    return types;
}

} // namespace

const NamedType* find_type(const std::string& name)
{
    static const Types types = make_types();
    const auto found = types.find(name);
    return found == types.end() ? nullptr : &found->second;
}

const binary::TypeRegistry& known_types()
{
    static const binary::TypeRegistry registry{binary::namespace0_types()};
    return registry;
}

ExtensionObject extension_from_json(const Json& json)
{
    const auto name = json.at("type").get<std::string>();
    const NamedType* const type = find_type(name);
    if (type == nullptr) {
        throw std::runtime_error("add " + name + " to the list of structures");
    }
    return type->to_extension(json.at("value"));
}

Json extension_to_json(const ExtensionObject& object)
{
    const std::string name{object.type()->name};
    const NamedType* const type = find_type(name);
    if (type == nullptr) {
        throw std::runtime_error("add " + name + " to the list of structures");
    }
    return {{"type", name}, {"value", type->from_extension(object)}};
}

} // namespace busbar::test
