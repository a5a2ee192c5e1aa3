#include <catch2/catch.hpp>

#include <busbar/model/nodeset.hpp>
#include <busbar/types/ids.hpp>

#include "tool/nodes/space_builder.hpp"

namespace export_test {

using namespace busbar;
using namespace busbar::tool;

namespace {

ReferenceDescription reference(std::uint32_t type, bool is_forward, const NodeId& target)
{
    ReferenceDescription description;
    description.reference_type_id = NodeId{0, type};
    description.is_forward = is_forward;
    description.node_id = ExpandedNodeId{target};
    return description;
}

RemoteNode node(std::uint32_t number, NodeClass node_class, const char* name)
{
    RemoteNode node;
    node.id = NodeId{1, number};
    node.node_class = node_class;
    node.attributes[AttributeId::BrowseName] = QualifiedName{0, String{name}};
    node.attributes[AttributeId::DisplayName] = LocalizedText{name};
    return node;
}

/// A structure and its encoding, which the structure tells of only.
std::vector<RemoteNode> structure_with_encoding()
{
    RemoteNode type = node(1, NodeClass::DataType, "Point");
    type.references.push_back(reference(id::HasSubtype, false, NodeId{0, id::Structure}));
    type.references.push_back(reference(id::HasEncoding, true, NodeId{1, 2}));
    RemoteNode encoding = node(2, NodeClass::Object, "Default Binary");
    encoding.references.push_back(
        reference(id::HasTypeDefinition, true, NodeId{0, id::DataTypeEncodingType}));
    return {encoding, type};
}

} // namespace

TEST_CASE("encodings that only their DataTypes tell of are exported")
{
    std::vector<RemoteNode> nodes = structure_with_encoding();
    adopt_orphans(nodes);
    SpaceBuilder builder{{"http://opcfoundation.org/UA/", "urn:test"}};
    builder.add(nodes);
    CHECK(builder.left_out().empty());
    REQUIRE(builder.space().find(NodeId{1, 2}) != model::no_node);
    const std::uint16_t wanted[] = {1};
    model::NodeSetExtras extras;
    extras.models.emplace_back().uri = "urn:test";
    const auto text = model::write_nodeset(builder.space(), wanted, extras);
    REQUIRE(text);
    CHECK(text->find("Default Binary") != std::string::npos);
    CHECK(text->find("\"i=38\"") != std::string::npos); // HasEncoding
}

TEST_CASE("a node that tells of its parent gets no other")
{
    std::vector<RemoteNode> nodes = structure_with_encoding();
    nodes[0].references.push_back(reference(id::HasEncoding, false, NodeId{1, 1}));
    const std::size_t count = nodes[0].references.size();
    adopt_orphans(nodes);
    CHECK(nodes[0].references.size() == count);
    CHECK(nodes[1].references.size() == 2);
}

TEST_CASE("what describes sessions is not exported")
{
    // A session's Object, its Variable, and a Variable that is the machine's.
    std::vector<RemoteNode> nodes{node(1, NodeClass::Object, "Session1"),
                                  node(2, NodeClass::Variable, "SessionDiagnostics"),
                                  node(3, NodeClass::Variable, "Level")};
    nodes[0].references.push_back(
        reference(id::HasComponent, false,
                  NodeId{0, id::Server_ServerDiagnostics_SessionsDiagnosticsSummary}));
    nodes[0].references.push_back(reference(id::HasComponent, true, NodeId{1, 2}));
    nodes[1].references.push_back(reference(id::HasComponent, false, NodeId{1, 1}));
    nodes[2].references.push_back(reference(id::Organizes, false, NodeId{0, id::ObjectsFolder}));
    leave_out_diagnostics(nodes);
    REQUIRE(nodes.size() == 1);
    CHECK(nodes[0].id == NodeId{1, 3});
}

} // namespace export_test
