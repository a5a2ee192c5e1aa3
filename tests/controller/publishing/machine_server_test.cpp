#include <catch2/catch.hpp>

#include <optional>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/harness/catch.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/view.hpp>

#include "machine_parts.hpp"

namespace machine_server_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

/// A server that publishes a program whose values lie in memory, and a client of it.
struct MachineServer : harness::BenchFixture {
    MachineServer()
    {
        MachineNodesOptions options = machine_options();
        options.source = host().add_source(memory);
        nodes = MachineNodes::create(space(), published.program, published.publication, options)
                    .value();
        for (const PublishedVariable& each : published.publication.published()) {
            const Variant value = initial_value(each);
            REQUIRE(memory.add(value) < published.publication.published().size());
        }
    }

    /// Of a scalar or an array of one dimension; texts and matrices are none of the program's.
    [[nodiscard]] Variant initial_value(const PublishedVariable& of)
    {
        const MachineDataType type = nodes->types().of(of.program->resolve(of.variable->type));
        if (type.built_in != BuiltInType::ExtensionObject) {
            return type.built_in == BuiltInType::UInt16 ? Variant{std::uint16_t{0xBEEF}}
                                                        : Variant{std::int16_t{7}};
        }
        const auto* const definition = data_types.of(space()).find(type.data_type);
        REQUIRE(definition != nullptr);
        CHECK(definition->encoding_id == type.encoding);
        return Variant{binary::to_extension_object(binary::DynamicValue{*definition}).value()};
    }
    [[nodiscard]] model::AddressSpace& space() { return server().address_space(); }
    [[nodiscard]] NodeId id_of(const char* text) const { return {nodes->namespace_index(), text}; }
    [[nodiscard]] DataValue read(const char* id, AttributeId attribute = AttributeId::Value)
    {
        return Bench::read(id_of(id), attribute);
    }
    StatusCode write(const char* id, Variant value)
    {
        return Bench::write(id_of(id), std::move(value));
    }
    /// The BrowseNames of what hierarchical references lead to.
    [[nodiscard]] std::vector<std::string> browse(const NodeId& node)
    {
        BrowseRequest request;
        request.nodes_to_browse.resize(1);
        request.nodes_to_browse[0].node_id = node;
        request.nodes_to_browse[0].reference_type_id = NodeId{0, id::HierarchicalReferences};
        request.nodes_to_browse[0].include_subtypes = true;
        request.nodes_to_browse[0].result_mask = 63; // BrowseResultMask All (Part 4, 7.3)
        const auto response = harness::need(call<BrowseResponse>(std::move(request)));
        std::vector<std::string> names;
        for (const ReferenceDescription& each : response.results[0].references) {
            names.push_back(each.browse_name.name.str());
        }
        return names;
    }

    Published published{machine_program()};
    model::DataTypes data_types;
    server::MemorySource memory{world().clock()};
    std::optional<MachineNodes> nodes;
};

} // namespace

TEST_CASE_METHOD(MachineServer, "A client browses the controller (6-2-1)")
{
    CHECK(browse(id_of("Controller/")) == std::vector<std::string>{"DeviceState", "GlobalVars"});
    CHECK(browse(id_of("Controller/DeviceState")) ==
          std::vector<std::string>{"ErrorState", "Mode", "UnpublishedVariablesStatus",
                                   "NumberOfPublishedVariables", "NumberOfValueAttributes"});
    CHECK(browse(id_of("Controller/GlobalVars")) ==
          std::vector<std::string>{"Axis1", "Grid", "Limit", "Points", "Speed", "State",
                                   "NodeVersion"});
    // Neither elements nor members have nodes.
    CHECK(browse(id_of("Axis1")).empty());
    CHECK(browse(id_of("Points")).empty());
}

TEST_CASE_METHOD(MachineServer, "A client reads and writes variables, but no constants (6-2-2)")
{
    CHECK(read("Speed").value == Variant{std::int16_t{7}});
    CHECK(write("Speed", Variant{std::int16_t{8}}) == status::Good);
    CHECK(read("Speed").value == Variant{std::int16_t{8}});
    CHECK(read("Limit").value == Variant{std::uint16_t{0xBEEF}});
    CHECK(write("Limit", Variant{std::uint16_t{0}}) == status::Bad_NotWritable);
    CHECK(read("Limit", AttributeId::AccessLevel).value == Variant{std::uint8_t{1}});
}

TEST_CASE_METHOD(MachineServer, "A client reads and writes a structure as a whole (6-2-2)")
{
    const NodeId axis_type = id_of("Types/Axis");
    CHECK(read("Axis1", AttributeId::DataType).value == Variant{axis_type});
    const auto* const axis = data_types.of(space()).find(axis_type);
    REQUIRE(axis != nullptr);
    binary::DynamicValue value{*axis};
    REQUIRE(value.set("m2", Variant{std::int32_t{1}}));
    REQUIRE(value.set("m4", Variant{"twenty bytes at most"}));
    const Variant written{binary::to_extension_object(value).value()};
    CHECK(write("Axis1", written) == status::Good);
    CHECK(read("Axis1").value == written);

    const auto* const point = data_types.of(space()).find(id_of("Types/Point"));
    REQUIRE(point != nullptr);
    CHECK(write("Axis1",
                Variant{binary::to_extension_object(binary::DynamicValue{*point}).value()}) ==
          status::Bad_TypeMismatch);
}

TEST_CASE_METHOD(MachineServer, "A client sees mode, error and what is added online (6-2-1)")
{
    CHECK(read("Controller/DeviceState/Mode").value == Variant{"PROGRAM"});
    nodes->set_mode(space(), OperatingMode::Run);
    nodes->set_error_state(space(), ErrorState::ContinuousError);
    CHECK(read("Controller/DeviceState/Mode").value == Variant{"RUN"});
    CHECK(read("Controller/DeviceState/ErrorState").value == Variant{"ContinuousError"});

    const Variant version = read("Controller/GlobalVars/NodeVersion").value;
    const Program edit{.variables = {variable("Added"), variable("Odd", array_of({}, {{1, 2}}))}};
    const ProgramTypes types = ProgramTypes::create(edit).value();
    published.publication.add(types);
    REQUIRE(memory.add(Variant{std::int16_t{9}}) == 6);
    REQUIRE(nodes->add_variables(space(), published.publication));
    CHECK(read("Added").value == Variant{std::int16_t{9}});
    CHECK(read("Odd").status == status::Bad_NodeIdUnknown);
    CHECK(read("Controller/DeviceState/NumberOfPublishedVariables").value ==
          Variant{std::uint32_t{7}});
    CHECK(read("Controller/DeviceState/UnpublishedVariablesStatus").value ==
          Variant{std::uint16_t{8}});
    run_for(std::chrono::milliseconds{1});
    CHECK(read("Controller/GlobalVars/NodeVersion").value != version);
}

} // namespace machine_server_test
