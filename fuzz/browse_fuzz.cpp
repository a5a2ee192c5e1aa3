#include <cstdint>

#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/node_management.hpp>
#include <busbar/types/view.hpp>

#include "fuzz_script.hpp"
#include "server_session.hpp"

namespace browse_fuzz {

using namespace busbar;

namespace {

/// Everybody may do anything.
class Users final : public server::UserStore {
public:
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view, std::string_view) override
    {
        return fail(status::Bad_UserAccessDenied);
    }
    [[nodiscard]] server::UserIdentity anonymous() const override
    {
        server::UserIdentity user;
        user.roles = {"ConfigureAdmin"};
        return user;
    }
};

struct Backend {
    Users users;
};

struct Fixture : Backend, fuzz::ServerSession {
    Fixture() : fuzz::ServerSession{&users, true}
    {
        auto& space = server.address_space();
        model::NewNode view;
        view.id = NodeId{1, 1U};
        view.browse_name = QualifiedName{1, "1"};
        view.parent = space.find(id::ViewsFolder);
        static_cast<void>(space.add_view(view));
        log_in();
    }
};

/// One of a few nodes of which some come and go.
NodeId node(fuzz::Script& script)
{
    static constexpr std::uint32_t ids[] = {
        id::ObjectsFolder, id::Server,     id::ViewsFolder,          id::Organizes,
        id::HasComponent,  id::FolderType, id::BaseDataVariableType, 0};
    const std::uint8_t choice = script.byte();
    return choice % 2 == 0 ? NodeId{0, ids[choice / 2 % 8]} : NodeId{1, choice / 2U % 16U};
}

QualifiedName name(fuzz::Script& script)
{
    const std::uint8_t choice = script.byte();
    return {static_cast<std::uint16_t>(choice % 3U), String{std::to_string(choice / 3U % 16U)}};
}

void browse(Fixture& fixture, fuzz::Script& script)
{
    BrowseRequest request;
    const std::uint8_t choice = script.byte();
    request.view.view_id = (choice & 1U) != 0 ? NodeId{1, 1U} : NodeId{};
    request.view.view_version = (choice & 2U) != 0 ? 1 : 0;
    request.requested_max_references_per_node = choice / 4U % 4U;
    request.nodes_to_browse.resize(choice / 16U % 4U);
    for (BrowseDescription& each : request.nodes_to_browse) {
        each.node_id = node(script);
        each.browse_direction = BrowseDirection{script.byte() % 4};
        each.reference_type_id = node(script);
        each.include_subtypes = true;
        each.node_class_mask = script.byte();
        each.result_mask = script.byte();
    }
    fixture.send(std::move(request));
}

/// With the continuation points of the last response, or others.
void browse_next(Fixture& fixture, fuzz::Script& script, std::span<const std::byte> last)
{
    BrowseNextRequest request;
    request.release_continuation_points = script.byte() % 4 == 0;
    binary::Reader reader{last};
    NodeId type;
    BrowseResponse response;
    decode(reader, type);
    if (type.is(BrowseResponse::binary_encoding_id)) {
        decode(reader, response);
    }
    for (const BrowseResult& result : response.results) {
        request.continuation_points.push_back(result.continuation_point);
    }
    if (request.continuation_points.empty()) {
        request.continuation_points.emplace_back(ByteString{script.bytes(16)});
    }
    fixture.send(std::move(request));
}

void translate(Fixture& fixture, fuzz::Script& script)
{
    TranslateBrowsePathsToNodeIdsRequest request;
    BrowsePath& path = request.browse_paths.emplace_back();
    path.starting_node = node(script);
    for (int left = script.byte() % 4; left > 0; --left) {
        RelativePathElement& element = path.relative_path.elements.emplace_back();
        const std::uint8_t choice = script.byte();
        element.reference_type_id = node(script);
        element.is_inverse = (choice & 1U) != 0;
        element.include_subtypes = (choice & 2U) != 0;
        element.target_name = name(script);
    }
    fixture.send(std::move(request));
}

/// Of each type that an Attribute has.
Variant attribute_value(fuzz::Script& script)
{
    const std::uint8_t choice = script.byte();
    switch (choice % 10) {
    case 0:
        return Variant{std::int32_t{script.byte()} - 4};
    case 1:
        return Variant{LocalizedText{"en", "text"}};
    case 2:
        return Variant{choice < 128};
    case 3:
        return Variant{Array<std::uint32_t>(script.byte() % 4U)};
    case 4:
        return Variant{script.byte()};
    case 5:
        return Variant{std::uint32_t{script.byte()}};
    case 6:
        return Variant{script.byte() - 4.0};
    case 7:
        return Variant{node(script)};
    case 8: {
        EnumDefinition definition;
        definition.fields.resize(script.byte() % 3U);
        return Variant{ExtensionObject::from(std::move(definition))};
    }
    default:
        return {};
    }
}

void add_node(Fixture& fixture, fuzz::Script& script)
{
    AddNodesRequest request;
    AddNodesItem& item = request.nodes_to_add.emplace_back();
    item.parent_node_id = node(script);
    item.reference_type_id = node(script);
    item.requested_new_node_id = node(script);
    item.browse_name = name(script);
    item.node_class = NodeClass{1 << script.byte() % 9};
    item.type_definition = node(script);
    const std::uint8_t choice = script.byte();
    if (choice % 3 == 0) {
        GenericAttributes attributes;
        for (unsigned left = 1 + choice / 3U % 4U; left > 0; --left) {
            const std::uint32_t attribute = script.byte() % 32U;
            attributes.attribute_values.push_back({attribute, attribute_value(script)});
        }
        item.node_attributes = ExtensionObject::from(std::move(attributes));
    } else if (choice % 3 == 1) {
        const std::uint32_t encoding = ObjectAttributes::binary_encoding_id + choice / 3U % 8U * 3U;
        item.node_attributes = ExtensionObject::from_binary(
            NodeId{0, encoding}, ByteString{script.bytes(script.byte() % 48U)});
    }
    fixture.send(std::move(request));
}

void change_reference(Fixture& fixture, fuzz::Script& script)
{
    const NodeId source = node(script);
    const NodeId type = node(script);
    const NodeId target = node(script);
    const std::uint8_t choice = script.byte();
    const bool is_forward = (choice & 1U) != 0;
    if ((choice & 2U) != 0) {
        DeleteReferencesRequest request;
        request.references_to_delete = {{source, type, is_forward, target, true}};
        return fixture.send(std::move(request));
    }
    AddReferencesRequest request;
    request.references_to_add = {
        {source, type, is_forward, {}, target, NodeClass{1 << choice / 4 % 8}}};
    fixture.send(std::move(request));
}

void delete_node(Fixture& fixture, fuzz::Script& script)
{
    DeleteNodesRequest request;
    request.nodes_to_delete = {{node(script), true}};
    fixture.send(std::move(request));
}

} // namespace

/// Browses and changes an address space in any order.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    Fixture fixture;
    for (int step = 0; step < 48 && !script.is_over(); ++step) {
        const auto last = fixture.responses.empty() ? std::vector<std::byte>{}
                                                    : std::move(fixture.responses.back());
        fixture.responses.clear();
        switch (script.byte() % 8) {
        case 0:
        case 1:
            browse(fixture, script);
            break;
        case 2:
            browse_next(fixture, script, last);
            break;
        case 3:
            translate(fixture, script);
            break;
        case 4:
        case 5:
            add_node(fixture, script);
            break;
        case 6:
            change_reference(fixture, script);
            break;
        default:
            delete_node(fixture, script);
        }
    }
    return 0;
}

} // namespace browse_fuzz
