#include <algorithm>
#include <array>
#include <iterator>
#include <optional>

#include <catch2/catch.hpp>

#include <busbar/server/modules.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/node_management.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

#include "support/server_fixture.hpp"

namespace modules_test {

using namespace busbar;
using namespace busbar::test;

namespace {

struct ModuleFixture : ServerFixture {
    explicit ModuleFixture(server::ModuleTable modules) { server = *create(modules); }

    Configured<server::Server> create(server::ModuleTable modules,
                                      server::ServerConfig config = insecure_config())
    {
        server::ServerEnvironment environment;
        environment.random = &random;
        environment.wall_clock = &wall_clock;
        environment.log = &log;
        environment.validator = &validator;
        environment.users = &users;
        return server::Server::create(modules, std::move(config), environment);
    }

    /// True if the server carries the service out, with whatever result.
    template <typename Request, typename Response>
    [[nodiscard]] bool serves()
    {
        return client().template status_of<Response>(Request{}) != status::Bad_ServiceUnsupported;
    }
    TestClient& client()
    {
        if (!client_) {
            client_.emplace(log_in());
        }
        return *client_;
    }
    /// What becomes of an item of the attribute of the Server object.
    StatusCode monitor(AttributeId attribute, ExtensionObject filter = {})
    {
        CreateSubscriptionRequest subscribe;
        const auto subscription = client().call<CreateSubscriptionResponse>(subscribe);
        CreateMonitoredItemsRequest request;
        request.subscription_id = subscription.value().subscription_id;
        request.items_to_create.emplace_back();
        MonitoredItemCreateRequest& item = request.items_to_create.back();
        item.item_to_monitor.node_id = NodeId{0, id::Server};
        item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(attribute);
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.filter = std::move(filter);
        const auto made = client().call<CreateMonitoredItemsResponse>(request);
        return made.value().results[0].status_code;
    }
    [[nodiscard]] DataValue read(std::uint32_t node)
    {
        ReadRequest request;
        request.nodes_to_read.emplace_back();
        request.nodes_to_read[0].node_id = NodeId{0, node};
        request.nodes_to_read[0].attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        return client().call<ReadResponse>(request).value().results[0];
    }

private:
    std::optional<TestClient> client_;
};

ExtensionObject event_filter()
{
    EventFilter filter;
    filter.select_clauses.emplace_back();
    filter.select_clauses[0].attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    filter.select_clauses[0].browse_path.push_back({0, "Message"});
    return ExtensionObject::from(filter);
}

} // namespace

TEST_CASE("a module brings its services, and who has not got it answers Bad_ServiceUnsupported")
{
    struct Row {
        const server::Module* module;
        bool (*is_there)(ModuleFixture& fixture);
    };
    const Row rows[] = {
        {&server::modules::methods,
         [](ModuleFixture& fixture) { return fixture.serves<CallRequest, CallResponse>(); }},
        {&server::modules::triggering,
         [](ModuleFixture& fixture) {
             return fixture.serves<SetTriggeringRequest, SetTriggeringResponse>();
         }},
        {&server::modules::transfer,
         [](ModuleFixture& fixture) {
             return fixture.serves<TransferSubscriptionsRequest, TransferSubscriptionsResponse>();
         }},
        {&server::modules::events,
         [](ModuleFixture& fixture) {
             return fixture.monitor(AttributeId::EventNotifier, event_filter()) == status::Good;
         }},
        {&server::modules::diagnostics,
         [](ModuleFixture& fixture) {
             return fixture.read(id::Server_ServerDiagnostics_ServerDiagnosticsSummary)
                        .value.get_if<ExtensionObject>() != nullptr;
         }},
    };
    for (const Row& row : rows) {
        INFO(row.module->name);
        ModuleFixture without{server::micro_modules()};
        CHECK_FALSE(row.is_there(without));
        const std::array alone{row.module};
        ModuleFixture with{alone};
        // The smallest namespace 0 has no nodes for diagnostics.
        const bool has_nodes =
            row.module != &server::modules::diagnostics ||
            with.server.address_space().find(
                id::Server_ServerDiagnostics_ServerDiagnosticsSummary) != model::no_node;
        CHECK(row.is_there(with) == has_nodes);
    }
}

TEST_CASE("what every server has needs no module")
{
    ModuleFixture fixture{server::micro_modules()};
    CHECK(fixture.read(id::Server_ServerStatus_State).status == status::Good);
    CHECK(fixture.monitor(AttributeId::DisplayName) == status::Good);
    CHECK(fixture.serves<BrowseRequest, BrowseResponse>());
    CHECK(fixture.serves<PublishRequest, PublishResponse>());
    auto secure = fixture.log_in(setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt));
    CHECK(secure.close_session() == status::Good);
}

TEST_CASE("the tables grow from one to the next")
{
    const auto holds = [](server::ModuleTable table, const server::Module* module) {
        return std::find(table.begin(), table.end(), module) != table.end();
    };
    const server::ModuleTable tables[] = {server::micro_modules(), server::embedded_modules(),
                                          server::standard_modules(), server::full_modules()};
    for (std::size_t i = 1; i < std::size(tables); ++i) {
        CHECK(tables[i - 1].size() < tables[i].size());
        for (const server::Module* module : tables[i - 1]) {
            INFO(module->name);
            CHECK(holds(tables[i], module));
        }
        ModuleFixture fixture{tables[i]};
        CHECK(fixture.serves<CallRequest, CallResponse>());
    }
}

TEST_CASE("an item of events is Bad_NotSupported without events")
{
    ModuleFixture fixture{server::micro_modules()};
    CHECK(fixture.monitor(AttributeId::EventNotifier, event_filter()) == status::Bad_NotSupported);
    CHECK(fixture.server.event_queue() == nullptr);
    CHECK_FALSE(fixture.server.raise_event(server::Event{}));
}

TEST_CASE("a configuration that asks for a module that is not there is refused")
{
    ModuleFixture fixture{server::full_modules()};
    SECTION("node management")
    {
        server::ServerConfig config = ServerFixture::insecure_config();
        config.has_node_management = true;
        const auto refused = fixture.create(server::standard_modules(), config);
        CHECK(text(refused.error()) == "has_node_management: needs modules::node_management");
        CHECK(fixture.log.text.find(text(refused.error())) != std::string::npos);
        const std::array alone{&server::modules::node_management};
        CHECK(fixture.create(alone, config));
    }
    SECTION("issued tokens")
    {
        server::ServerConfig config = ServerFixture::secure_config();
        config.endpoints[0].allows_issued = true;
        fixture.users.rules.emplace();
        const auto refused = fixture.create(server::standard_modules(), config);
        CHECK(text(refused.error()) == "allows_issued: needs modules::issued_tokens");
        const std::array alone{&server::modules::issued_tokens};
        CHECK(fixture.create(alone, config));
    }
}

TEST_CASE("structures of namespace 0 are known where a module needs them")
{
    const auto is_known = [](server::ModuleTable modules, const NodeId& encoding) {
        ModuleFixture fixture{modules};
        return fixture.server.types().find(encoding) != nullptr;
    };
    const NodeId range{0, Range::binary_encoding_id};
    const NodeId event{0, EventFilter::binary_encoding_id};
    const NodeId attributes{0, ObjectAttributes::binary_encoding_id};
    const NodeId other{0, AddNodesItem::binary_encoding_id};
    CHECK(is_known(server::micro_modules(), range));
    CHECK_FALSE(is_known(server::micro_modules(), event));
    CHECK(is_known(server::standard_modules(), event));
    CHECK_FALSE(is_known(server::standard_modules(), attributes));
    const std::array management{&server::modules::node_management};
    CHECK(is_known(management, attributes));
    CHECK_FALSE(is_known(management, other));
    for (const NodeId& each : {range, event, attributes, other}) {
        CHECK(is_known(server::full_modules(), each));
    }
}

} // namespace modules_test
