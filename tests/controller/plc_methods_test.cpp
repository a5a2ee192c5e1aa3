#include <catch2/catch.hpp>

#include <busbar/controller/plc_methods.hpp>
#include <busbar/controller/plc_nodes.hpp>

namespace plc_methods_test {

using namespace busbar;
using namespace busbar::controller;

TEST_CASE("ResetCounters sets back what programs count, with the next scan")
{
    PlcConfig config;
    config.variables.resize(3);
    config.variables[0].name = "Counter";
    config.variables[1].name = "Array";
    config.variables[1].type = BuiltInType::Double;
    config.variables[1].dimensions = {3};
    config.variables[2].name = "Other";
    config.variables[2].initial = Variant{std::int64_t{5}};
    config.programs.resize(2);
    config.programs[0].target = "Counter";
    config.programs[1].target = "Array";
    const auto plc = std::move(Plc::create(config).value());
    const auto value = [&](std::uint32_t handle) { return plc->image()->memory().load(handle); };
    const auto scan = [&] { plc->scan(DateTime{}, std::chrono::milliseconds{20}); };
    scan();
    scan();
    CHECK(value(0) == Variant{2});
    CHECK(plc->counter_count() == 2);
    plc->reset_counters();
    CHECK(value(0) == Variant{2});
    scan();
    CHECK(value(0) == Variant{0});
    CHECK(value(1) == Variant{Array<double>{0, 0, 0}});
    CHECK(value(2) == Variant{5});
    scan();
    CHECK(value(0) == Variant{1});
}

TEST_CASE("the PLC's Methods are components of its folder")
{
    const auto plc = std::move(Plc::create({}).value());
    model::AddressSpace space;
    server::MethodTable table;
    const auto folder = publish_variables(space, *plc, {});
    REQUIRE(folder);
    REQUIRE(publish_methods(space, *folder, *plc, table, 3));
    const auto index = space.namespace_index("urn:busbar:plc");
    const auto method = space.find(NodeId{*index, "ResetCounters"});
    REQUIRE(method != model::no_node);
    CHECK(space.method(method).source == 3);
    CHECK(publish_methods(space, *folder, *plc, table, 3).error() == status::Bad_NodeIdExists);
}

} // namespace plc_methods_test
