#include "administration_calls.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/client/response.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/core/text.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/configuration.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/view.hpp>

#include "load.hpp"
#include "own_server.hpp"

namespace busbar::bench {

namespace {

constexpr std::size_t max_depth = 6;

/// They end the server, or are of Subscriptions.
constexpr std::array<std::string_view, 5> left_out{"RequestServerStateChange",
                                                   "ResetToServerDefaults", "GetMonitoredItems",
                                                   "ResendData", "SetSubscriptionDurable"};

template <typename Response, typename Request>
Result<Response> exchange(net::ClientLoop& loop, Request& request)
{
    const auto event = loop.call(request);
    if (!event || event->status.is_bad()) {
        return fail(event ? event->status : event.error());
    }
    return client::decode_response<Response>(event->body, binary::Strings::Own, generous_limits());
}

/// Forward references of each node to Objects and Methods, or to Properties.
Result<std::vector<BrowseResult>> browse(net::ClientLoop& loop, const std::vector<NodeId>& nodes,
                                         bool wants_properties)
{
    BrowseDescription one;
    one.reference_type_id =
        NodeId{0, wants_properties ? id::HasProperty : id::HierarchicalReferences};
    one.include_subtypes = true;
    one.node_class_mask =
        static_cast<std::uint32_t>(wants_properties ? NodeClass::Variable : NodeClass::Object);
    one.node_class_mask |= wants_properties ? 0U : static_cast<std::uint32_t>(NodeClass::Method);
    one.result_mask = 63;
    BrowseRequest request;
    for (const NodeId& node : nodes) {
        one.node_id = node;
        request.nodes_to_browse.push_back(one);
    }
    auto response = exchange<BrowseResponse>(loop, request);
    if (!response) {
        return fail(response.error());
    }
    return std::vector<BrowseResult>{response->results.begin(), response->results.end()};
}

/// The Value, or another Attribute, of each node.
Result<std::vector<DataValue>> read(net::ClientLoop& loop, const std::vector<NodeId>& nodes,
                                    AttributeId attribute)
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    for (const NodeId& node : nodes) {
        ReadValueId& item = request.nodes_to_read.emplace_back();
        item.node_id = node;
        item.attribute_id = static_cast<std::uint32_t>(attribute);
    }
    auto response = exchange<ReadResponse>(loop, request);
    if (!response) {
        return fail(response.error());
    }
    return std::vector<DataValue>{response->results.begin(), response->results.end()};
}

/// The nodes that come with a server's types have no names here.
std::string name_of_type(const NodeId& type, std::string_view otherwise)
{
    static constexpr std::array<std::pair<std::uint32_t, std::string_view>, 8> known{
        {{id::FileType, "FileType"},
         {id::FileDirectoryType, "FileDirectoryType"},
         {id::TrustListType, "TrustListType"},
         {id::RoleType, "RoleType"},
         {id::RoleSetType, "RoleSetType"},
         {id::UserManagementType, "UserManagementType"},
         {id::ServerConfigurationType, "ServerConfigurationType"},
         {id::TemporaryFileTransferType, "TemporaryFileTransferType"}}};
    const auto* const found = std::find_if(known.begin(), known.end(),
                                           [&](const auto& each) { return type.is(each.first); });
    return std::string{found != known.end() ? found->second : otherwise};
}

/// Those that make something come before those that use it, and these before those that end it.
int phase_of(const AdministrationMethod& method)
{
    const std::string_view name = std::string_view{method.name}.substr(method.name.rfind('.') + 1);
    const auto begins = [&](std::initializer_list<std::string_view> words) {
        return std::any_of(words.begin(), words.end(),
                           [&](std::string_view word) { return name.starts_with(word); });
    };
    return begins({"Open", "Create", "Add", "Generate"})                            ? 0
           : begins({"Close", "Delete", "Remove", "MoveOrCopy", "Cancel", "Apply"}) ? 2
                                                                                    : 1;
}

Result<void> keep_executable(net::ClientLoop& loop, std::vector<AdministrationMethod>& methods)
{
    std::vector<NodeId> nodes;
    for (const AdministrationMethod& each : methods) {
        nodes.push_back(each.method);
    }
    const auto rights = read(loop, nodes, AttributeId::UserExecutable);
    if (!rights) {
        return fail(rights.error());
    }
    std::vector<AdministrationMethod> kept;
    for (std::size_t i = 0; i < methods.size() && i < rights->size(); ++i) {
        if ((*rights)[i].value == Variant{true}) {
            kept.push_back(std::move(methods[i]));
        }
    }
    methods = std::move(kept);
    return {};
}

Result<void> read_inputs(net::ClientLoop& loop, AdministrationMethod& method)
{
    const auto properties = browse(loop, {method.method}, true);
    if (!properties || properties->empty()) {
        return properties ? Result<void>{} : fail(properties.error());
    }
    for (const ReferenceDescription& each : properties->front().references) {
        if (each.browse_name.name != "InputArguments") {
            continue;
        }
        const auto values = read(loop, {each.node_id.node_id}, AttributeId::Value);
        if (!values) {
            return fail(values.error());
        }
        const auto* const list = values->front().value.array_if<ExtensionObject>();
        for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
            if (auto argument = binary::structure_of<Argument>((*list)[i])) {
                method.inputs.push_back(*std::move(argument));
            }
        }
    }
    return {};
}

/// What lies below Objects, level by level.
class Search {
public:
    explicit Search(net::ClientLoop& loop) : loop_{loop} {}

    Result<std::vector<AdministrationMethod>> run()
    {
        std::vector<Found> level{{NodeId{0, id::ObjectsFolder}, {}}};
        for (std::size_t depth = 0; depth < max_depth && !level.empty(); ++depth) {
            std::vector<NodeId> nodes;
            for (const Found& each : level) {
                nodes.push_back(each.node);
            }
            const auto results = browse(loop_, nodes, false);
            if (!results) {
                return fail(results.error());
            }
            std::vector<Found> next;
            for (std::size_t i = 0; i < results->size() && i < level.size(); ++i) {
                for (const ReferenceDescription& each : (*results)[i].references) {
                    take(level[i], each, next);
                }
            }
            level = std::move(next);
        }
        return std::move(methods_);
    }

private:
    struct Found {
        NodeId node;
        std::string name;
    };

    void take(const Found& parent, const ReferenceDescription& reference, std::vector<Found>& next)
    {
        const NodeId& node = reference.node_id.node_id;
        const std::string_view name = reference.browse_name.name.view();
        if (reference.node_class == NodeClass::Object) {
            if (seen_.insert(to_string(node)).second) {
                next.push_back({node, name_of_type(reference.type_definition.node_id, name)});
            }
            return;
        }
        const std::string full = parent.name + "." + std::string{name};
        if (std::find(left_out.begin(), left_out.end(), name) == left_out.end() &&
            names_.insert(full).second) {
            methods_.push_back({full, parent.node, node, {}});
        }
    }

    net::ClientLoop& loop_;
    std::vector<AdministrationMethod> methods_;
    std::set<std::string> seen_;
    std::set<std::string> names_;
};

} // namespace

Result<std::vector<AdministrationMethod>> find_methods(net::ClientLoop& loop)
{
    auto methods = Search{loop}.run();
    if (!methods) {
        return methods;
    }
    if (const auto kept = keep_executable(loop, *methods); !kept) {
        return fail(kept.error());
    }
    for (AdministrationMethod& each : *methods) {
        if (const auto done = read_inputs(loop, each); !done) {
            return fail(done.error());
        }
    }
    // Files before folders, which take their places.
    std::sort(methods->begin(), methods->end(),
              [](const AdministrationMethod& a, const AdministrationMethod& b) {
                  return std::tuple{phase_of(a), std::string_view{b.name}} <
                         std::tuple{phase_of(b), std::string_view{a.name}};
              });
    return methods;
}

Variant AdministrationCalls::array_of(const Argument& argument)
{
    if (argument.data_type.is(id::String)) {
        return Variant{Array<String>{"limits.sessions"}};
    }
    if (argument.data_type.is(id::ByteString)) {
        return Variant{Array<ByteString>{}};
    }
    return Variant{Array<Variant>{Variant{static_cast<std::int64_t>(100 + ++names_ % 100)}}};
}

Variant AdministrationCalls::value_of(const Argument& argument, std::size_t number,
                                      const Given& given)
{
    const NodeId& type = argument.data_type;
    const std::string_view name = argument.name.view();
    const auto new_name = [&] { return String{"bench " + std::to_string(++names_)}; };
    if (argument.value_rank >= 1) {
        return array_of(argument);
    }
    if (type.is(id::String)) {
        return name.find("Password") != name.npos    ? Variant{String{good_password}}
               : name.find("Namespace") != name.npos ? Variant{String{}}
               : name.find("Format") != name.npos    ? Variant{"PEM"}
               : name.find("Subject") != name.npos   ? Variant{"CN=Bench"}
                                                     : Variant{new_name()};
    }
    if (type.is(id::NodeId)) {
        return name.find("Group") != name.npos
                   ? Variant{NodeId{
                         0, id::ServerConfiguration_CertificateGroups_DefaultApplicationGroup}}
               : name.find("CertificateType") != name.npos
                   ? Variant{NodeId{0, id::RsaSha256ApplicationCertificateType}}
               : number < given.nodes.size() ? Variant{given.nodes[number]}
                                             : Variant{NodeId{}};
    }
    if (type.is(id::UInt32)) {
        return Variant{name.ends_with("Handle") ? given.handle : std::uint32_t{0}};
    }
    if (type.is(id::Boolean)) {
        return Variant{name.find("Trusted") != name.npos};
    }
    if (type.is(id::ByteString)) {
        return Variant{ByteString{std::vector<std::byte>(100)}};
    }
    if (type.is(id::Byte)) {
        return Variant{std::uint8_t{1}};
    }
    if (type.is(id::UInt16)) {
        return Variant{std::uint16_t{2'048}};
    }
    if (type.is(id::Int32)) {
        return Variant{std::int32_t{100}};
    }
    if (type.is(id::UInt64)) {
        return Variant{std::uint64_t{0}};
    }
    if (type.is(id::IdentityMappingRuleType)) {
        return Variant{ExtensionObject::from(
            IdentityMappingRuleType{IdentityCriteriaType::UserName, new_name()})};
    }
    if (type.is(id::EndpointType)) {
        EndpointType endpoint;
        endpoint.endpoint_url = new_name();
        return Variant{ExtensionObject::from(std::move(endpoint))};
    }
    // UserConfigurationMask and others are numbers; a BaseDataType may be anything.
    return type.is(id::BaseDataType) ? Variant{} : Variant{std::uint32_t{0}};
}

void AdministrationCalls::note(const CallResponse& response, Given& given) const
{
    std::vector<NodeId> nodes;
    for (const CallMethodResult& result : response.results) {
        for (const Variant& output : result.output_arguments) {
            if (const auto* const node = output.get_if<NodeId>(); node != nullptr) {
                nodes.push_back(NodeId{*node});
            } else if (const auto* const handle = output.get_if<std::uint32_t>()) {
                given.handle = *handle != 0 ? *handle : given.handle;
            }
        }
    }
    if (!nodes.empty()) {
        given.nodes = std::move(nodes);
    }
}

CallRequest AdministrationCalls::request(const AdministrationMethod& method, std::size_t count)
{
    const Given& given = given_[to_string(method.object)];
    CallRequest request;
    for (std::size_t i = 0; i < count; ++i) {
        CallMethodRequest& one = request.methods_to_call.emplace_back();
        one.object_id = method.object;
        one.method_id = method.method;
        for (const Argument& input : method.inputs) {
            one.input_arguments.push_back(value_of(input, i, given));
        }
    }
    return request;
}

Result<AdministrationCalls::Outcome> AdministrationCalls::call(net::ClientLoop& loop,
                                                               const AdministrationMethod& method,
                                                               std::size_t count)
{
    CallRequest calls = request(method, count);
    const auto response = exchange<CallResponse>(loop, calls);
    if (!response) {
        return fail(response.error());
    }
    Outcome outcome;
    for (const CallMethodResult& result : response->results) {
        if (result.status_code.is_bad() && outcome.bad++ == 0) {
            outcome.status = name(result.status_code);
        }
        outcome.good += result.status_code.is_bad() ? 0U : 1U;
    }
    note(*response, given_[to_string(method.object)]);
    return outcome;
}

} // namespace busbar::bench
