#include <catch2/catch.hpp>

#include <array>

#include <busbar/core/text_forms.hpp>
#include <busbar/model/nodeset_types.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/view.hpp>

#include "event_fixture.hpp"
#include "subscription_fixture.hpp"

namespace model_change_event_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr Duration cycle = 100ms;

struct ChangeFixture : SubscriptionFixture {
    ChangeFixture()
    {
        const auto& space = server.address_space();
        REQUIRE(server.address_space().add_folder(named("line", space.find(id::ObjectsFolder))));
        MonitoredItemCreateRequest item = item_request(NodeId{0, id::Server}, 7);
        item.item_to_monitor.attribute_id = 12;
        item.requested_parameters.queue_size = 10;
        EventFilter filter = selecting({"EventType", "SourceName"});
        filter.select_clauses.push_back(
            field({QualifiedName{0, "Changes"}}, NodeId{0, id::BaseEventType}));
        item.requested_parameters.filter = ExtensionObject::from(std::move(filter));
        REQUIRE(monitor(client, subscription, item).status_code == status::Good);
    }
    [[nodiscard]] model::NewNode named(const std::string& name, model::NodeIndex parent) const
    {
        model::NewNode node;
        node.id = NodeId{1, String{name}};
        node.browse_name = QualifiedName{1, String{name}};
        node.parent = parent;
        return node;
    }
    void add_version(const NodeId& of)
    {
        auto& space = server.address_space();
        model::NewNode node;
        node.id = space.free_id(1);
        node.browse_name = QualifiedName{0, "NodeVersion"};
        node.parent = space.find(of);
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::String};
        REQUIRE(space.add_property(node, variable));
    }
    [[nodiscard]] std::string version(const NodeId& of)
    {
        const auto& space = server.address_space();
        return space.value(space.journal().node_version(space.find(of)))
            .value_or<String>(String{})
            .str();
    }
    /// The parts of one kind of the next message.
    template <typename Part>
    std::vector<Part> next_parts()
    {
        // One that was not answered still waits.
        pending_publish = pending_publish != 0 ? pending_publish : publish(client);
        advance(cycle);
        const auto response = take(client, pending_publish);
        std::vector<Part> parts;
        if (response) {
            pending_publish = 0;
            for (const auto& part : response->notification_message.notification_data) {
                if (const auto* found = part.template get_if<Part>()) {
                    parts.push_back(*found);
                }
            }
        }
        return parts;
    }
    std::vector<EventFieldList> next_events()
    {
        std::vector<EventFieldList> all;
        for (const auto& part : next_parts<EventNotificationList>()) {
            all.insert(all.end(), part.events.begin(), part.events.end());
        }
        return all;
    }

    NodeId line{1, "line"};
    TestClient client{log_in()};
    std::uint32_t subscription{subscribe(client)};
    std::uint32_t pending_publish{0};
};

} // namespace

TEST_CASE_METHOD(ChangeFixture, "Clients are told of changes of nodes that have a NodeVersion",
                 "[unit:Base Info Model Change][unit:Base Info Model Change General]")
{
    auto& space = server.address_space();
    CHECK(server.next_deadline() > now);
    REQUIRE(space.add_folder(named("unversioned", space.find(id::ObjectsFolder))));
    CHECK(server.next_deadline() > now);
    add_version(line);
    CHECK(server.next_deadline() <= now);
    auto events = next_events();
    REQUIRE(events.size() == 1);
    CHECK(events[0].event_fields[0] == Variant{NodeId{0, id::GeneralModelChangeEventType}});
    CHECK(events[0].event_fields[1] == Variant{String{"Server"}});
    CHECK(version(line) == "1");

    // Many changes are one event.
    for (int i = 0; i < 50; ++i) {
        REQUIRE(space.add_folder(named("f" + std::to_string(i), space.find(line))));
    }
    REQUIRE(space.remove(space.find(NodeId{1, "f7"})));
    events = next_events();
    REQUIRE(events.size() == 1);
    const auto* const changes = events[0].event_fields[2].array_if<ExtensionObject>();
    REQUIRE(changes != nullptr);
    REQUIRE(changes->size() == 1);
    const auto* const change = (*changes)[0].get_if<ModelChangeStructureDataType>();
    REQUIRE(change != nullptr);
    CHECK(*change == ModelChangeStructureDataType{line, NodeId{0, id::FolderType}, 4 | 8});
    CHECK(version(line) == "2");
    CHECK(next_events().empty());
}

TEST_CASE_METHOD(ChangeFixture, "After too many changes clients learn that something has changed")
{
    auto& space = server.address_space();
    for (int i = 0; i < 1'100; ++i) {
        const std::string name = "f" + std::to_string(i);
        REQUIRE(space.add_folder(named(name, space.find(line))));
        add_version(NodeId{1, String{name}});
    }
    const auto events = next_events();
    REQUIRE(events.size() == 1);
    CHECK(events[0].event_fields[0] == Variant{NodeId{0, id::BaseModelChangeEventType}});
    CHECK(version(NodeId{1, "f1099"}) == "1");
}

TEST_CASE_METHOD(ChangeFixture, "Clients are told of properties that mean something else",
                 "[unit:Base Info SemanticChange]")
{
    server.announce_semantics_change(NodeId{1, "none"});
    CHECK(next_events().empty());
    const NodeId level = add_variable("level", std::int32_t{1});
    server.announce_semantics_change(level);
    const auto events = next_events();
    REQUIRE(events.size() == 1);
    CHECK(events[0].event_fields[0] == Variant{NodeId{0, id::SemanticChangeEventType}});
    const auto* const changes = events[0].event_fields[2].array_if<ExtensionObject>();
    REQUIRE(changes != nullptr);
    REQUIRE(changes->size() == 1);
    CHECK((*changes)[0] == ExtensionObject::from(SemanticChangeStructureDataType{
                               level, NodeId{0, id::BaseDataVariableType}}));
}

TEST_CASE_METHOD(ChangeFixture, "A monitored node may go and come again")
{
    const NodeId node = add_variable("speed", std::int32_t{1});
    REQUIRE(monitor(client, subscription, item_request(node)).status_code == status::Good);
    const auto next_value = [&] {
        const auto parts = next_parts<DataChangeNotification>();
        return parts.empty() ? DataValue{} : parts[0].monitored_items[0].value;
    };
    CHECK(next_value().value == Variant{std::int32_t{1}});
    auto& space = server.address_space();
    REQUIRE(space.remove(space.find(node)));
    advance(cycle);
    // Part 4, 5.8.4.1
    CHECK(next_value().status == status::Bad_NodeIdUnknown);
    // Another node in its place is not it.
    REQUIRE(space.add_folder(named("other", space.find(id::ObjectsFolder))));
    advance(cycle);
    CHECK(next_value() == DataValue{});
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.value = std::int32_t{5};
    add_variable("speed", variable);
    advance(cycle);
    CHECK(next_value().value == Variant{std::int32_t{5}});
}

TEST_CASE_METHOD(ChangeFixture, "Each namespace is described below Server.Namespaces",
                 "[unit:Base Info Namespace Metadata]")
{
    auto& space = server.address_space();
    const auto property = [&](std::string_view uri, const char* name) {
        Variant value;
        model::ReferenceCursor cursor = space.references(space.find(id::Server_Namespaces));
        while (const auto reference = cursor.next()) {
            if (reference->is_forward && space.browse_name(reference->target).name.view() == uri) {
                space.for_each_child(reference->target, space.find(id::HasProperty), true,
                                     QualifiedName{0, name}, [&](model::NodeIndex child) {
                                         value = space.value(child);
                                         return false;
                                     });
            }
        }
        return value;
    };
    const std::string& own = server.config().application_uri;
    CHECK(property(own, "NamespaceUri") == Variant{String{own}});
    CHECK(property(own, "IsNamespaceSubset") == Variant{false});
    CHECK(property("http://opcfoundation.org/UA/", "NamespaceUri") ==
          Variant{"http://opcfoundation.org/UA/"});

    const std::uint16_t index = space.add_namespace("urn:late").value();
    CHECK(server.next_deadline() <= now);
    server.handle_deadline(now);
    CHECK(server.next_deadline() > now);
    CHECK(property("urn:late", "NamespaceVersion") == Variant{String{""}});
    server::NamespaceMetadata metadata;
    metadata.version = "1.2";
    metadata.publication_date = DateTime{123};
    metadata.is_subset = true;
    metadata.static_node_id_types = {IdType::Numeric};
    metadata.static_numeric_ranges = {"1:99"};
    REQUIRE(server.describe_namespace(index, metadata));
    CHECK(property("urn:late", "DefaultAccessRestrictions").is_null()); // there is none
    metadata.default_access_restrictions = std::uint16_t{1};
    metadata.default_role_permissions.emplace().clear();
    REQUIRE(server.describe_namespace(index, metadata));
    CHECK(property("urn:late", "DefaultAccessRestrictions") == Variant{std::uint16_t{1}});
    CHECK(property("urn:late", "DefaultRolePermissions") == Variant{Array<ExtensionObject>(0)});
    CHECK(property("urn:late", "NamespaceVersion") == Variant{"1.2"});
    CHECK(property("urn:late", "NamespacePublicationDate") == Variant{DateTime{123}});
    CHECK(property("urn:late", "IsNamespaceSubset") == Variant{true});
    CHECK(property("urn:late", "StaticNodeIdTypes") == Variant{Array<std::int32_t>{0}});
    CHECK(property("urn:late", "StaticNumericNodeIdRange") == Variant{Array<String>{"1:99"}});
    CHECK(server.describe_namespace(99, metadata).error() == status::Bad_NotFound);
    // The metadata of files.
    model::NodeSetModel model;
    model.uri = server.address_space().namespace_uri(index);
    model.version = "2.1";
    model.publication_date = "2026-11-23T00:00:00Z";
    model::NodeSetModel stranger;
    stranger.uri = "urn:in no file";
    server::describe_models(server, std::array{stranger, model});
    CHECK(property("urn:late", "NamespaceVersion") == Variant{"2.1"});
    CHECK(property("urn:late", "NamespacePublicationDate") ==
          Variant{parse_date_time("2026-11-23T00:00:00Z").value()});
    // They say nothing of the rest.
    CHECK(property("urn:late", "IsNamespaceSubset") == Variant{true});
    CHECK(property("urn:late", "StaticNumericNodeIdRange") == Variant{Array<String>{"1:99"}});

    ReadRequest request;
    request.nodes_to_read.resize(1);
    request.nodes_to_read[0].node_id = NodeId{0, id::Server_NamespaceArray};
    request.nodes_to_read[0].attribute_id = 13;
    const auto read = client.call<ReadResponse>(request);
    REQUIRE(read);
    const auto* const uris = read->results[0].value.array_if<String>();
    REQUIRE(uris != nullptr);
    CHECK((*uris)[index] == String{"urn:late"});
}

} // namespace model_change_event_test
