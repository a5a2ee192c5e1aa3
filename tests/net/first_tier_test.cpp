#include <catch2/catch.hpp>

#include <busbar/model/address_space.hpp>
#include <busbar/net/server_app.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/event.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/types/ids.hpp>

#include "support/temporary_folder.hpp"

namespace first_tier_test {

using namespace busbar;
using model::Access;

namespace {

/// A tank whose level a client reads.
class Tank final : public server::DataSource {
public:
    static constexpr std::uint64_t level = 0;

    void read(server::ReadBatch batch) override
    {
        for (server::ReadSlot& slot : batch.results()) {
            slot = DataValue{Variant{level_}};
        }
        batch.complete();
    }
    void drain(double amount) { level_ -= amount; }

private:
    double level_{80};
};

/// A Method of the Line that drains the tank.
Result<model::NodeIndex> add_drain(model::AddressSpace& space, model::NodeIndex line,
                                   server::MethodTable& methods, Tank& tank)
{
    const std::uint16_t ns = space.node_id(line).namespace_index();
    model::NewNode node;
    node.id = NodeId{ns, "Line/Drain"};
    node.browse_name = {ns, "Drain"};
    node.parent = line;
    Argument amount;
    amount.name = "Amount";
    amount.data_type = NodeId{0, id::Double};
    amount.value_rank = -1;
    model::NewMethod drain;
    drain.input_arguments = {amount};
    drain.source = methods.index();
    drain.handle = methods.add([&tank](server::MethodCall call) {
        tank.drain(call.input<double>(0));
        call.succeed();
    });
    return space.add_method(node, drain);
}

} // namespace

TEST_CASE("the first tier of headers is enough for a whole server", "[net]")
{
    const test::TemporaryFolder folder;
    net::ServerApp app{{"urn:example:line", "Line", folder.path.string()},
                       "opc.tcp://localhost:48400"};
    app.add_user("operator", "a pass phrase");
    const std::uint16_t ns = app.add_namespace("urn:example:machine");
    auto& tank = app.make_source<Tank>();
    auto& methods = app.make_source<server::MethodTable>();
    app.add_variable({ns, "Level"}, tank.variable(Tank::level, 0.0));
    const auto limit = app.add_variable({ns, "Limit"}, 95.0, Access::ReadWrite);
    app.set(limit, 90.0);
    REQUIRE(app.status());

    model::AddressSpace& space = app.server()->address_space();
    model::NewNode line;
    line.id = NodeId{ns, "Line"};
    line.browse_name = {ns, "Line"};
    line.parent = space.find(id::ObjectsFolder);
    const auto added = space.add_folder(line);
    REQUIRE(added);
    CHECK(space.add_variable(*added, {ns, "Name"}, "Line 4"));
    CHECK(add_drain(space, *added, methods, tank));
    CHECK(space.variable(space.find(NodeId{ns, "Level"})).source == tank.index());
    const model::NodeIndex drain = space.find(NodeId{ns, "Line/Drain"});
    REQUIRE(drain != model::no_node);
    CHECK(space.method(drain).source == methods.index());

    server::Event event;
    event.source_node = line.id;
    event.message = LocalizedText{"en", "Level too high"};
    event.severity = 700;
    CHECK(app.server()->raise_event(std::move(event)));
}

} // namespace first_tier_test
