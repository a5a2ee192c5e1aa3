#include <busbar/controller/mapped_nodes.hpp>
#include <busbar/controller/module_status.hpp>

#include "mapped_fixture.hpp"

namespace mapped_nodes_test {

using namespace busbar;
using namespace busbar::test;
using controller::MappedPart;

namespace {

MappedPart element(std::uint32_t number, const char* label)
{
    MappedPart part;
    part.kind = MappedPart::Kind::Element;
    part.number = number;
    part.label = label;
    return part;
}

} // namespace

TEST_CASE_METHOD(MappedFixture, "8.3 Mapping: nodes are served by their labels", "[8.3]")
{
    plc->add("Speed", LabelType::Word, std::int16_t{4});
    plc->add("A", LabelType::Word, std::int16_t{5});
    plc->add("H", LabelType::UnsignedWord, std::uint16_t{0});
    plc->add("In", LabelType::Word, std::int16_t{0});
    model::AddressSpace& space = server.address_space();
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int16};
    variable.value = Variant{std::int16_t{1}};
    REQUIRE(space.add_variable(named("speed"), variable));
    REQUIRE(space.add_variable(named("unmapped"), variable));
    variable.value_rank = 1;
    variable.array_dimensions = {2};
    variable.value = Variant{Array<std::int16_t>{8, 9}};
    REQUIRE(space.add_variable(named("array"), variable));
    model::NewMethod method;
    method.input_arguments = {{"number", NodeId{0, id::Int16}, -1, {}, {}}};
    REQUIRE(space.add_method(named("start"), method));

    controller::Mapping mapping;
    mapping.variables[own("speed")].value.label = "Speed";
    mapping.variables[own("unmapped")];
    mapping.variables[own("array")].value.parts = {element(1, "A"), element(2, "A")};
    mapping.variables[own("absent")].value.label = "Speed";
    mapping.methods[own("start")].handle = "H";
    MappedPart input;
    input.label = "In";
    mapping.methods[own("start")].arguments = {input};
    const auto mapped = controller::map_nodes(space, types, mapping, source);
    CHECK(mapped.variables == 2);
    CHECK(mapped.methods == 1);
    CHECK(mapped.left_out.size() == 2);

    source.start();
    CHECK(book.errors.empty());
    CHECK(read(own("speed")).value == Variant{std::int16_t{4}});
    CHECK(read(own("array")).value == Variant{Array<std::int16_t>{8, 5}});
    CHECK(read(own("unmapped")).value == Variant{std::int16_t{1}});
    CallMethodRequest call;
    call.object_id = NodeId{0, id::ObjectsFolder};
    call.method_id = own("start");
    call.input_arguments = {Variant{std::int16_t{6}}};
    CallRequest request;
    request.methods_to_call = {call};
    const auto sent = client->send(request);
    complete();
    const auto response = client->take<CallResponse>(sent);
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Good);
    CHECK(plc->get<std::int16_t>("In") == 6);
    CHECK(plc->get<std::uint16_t>("H") == 1);
}

TEST_CASE_METHOD(MappedFixture, "2.1 Call: a Method with OutputArguments is refused", "[2.1]")
{
    plc->add("H", LabelType::UnsignedWord, std::uint16_t{0});
    plc->add("In", LabelType::Word, std::int16_t{0});
    model::AddressSpace& space = server.address_space();
    model::NewMethod method;
    method.input_arguments = {{"number", NodeId{0, id::Int16}, -1, {}, {}}};
    method.output_arguments = {{"result", NodeId{0, id::Int16}, -1, {}, {}}};
    REQUIRE(space.add_method(named("start"), method));
    controller::Mapping mapping;
    mapping.methods[own("start")].handle = "H";
    mapping.methods[own("start")].arguments = {{.label = "In"}};
    static_cast<void>(controller::map_nodes(space, types, mapping, source));
    source.start();
    CallRequest request;
    request.methods_to_call.resize(1);
    request.methods_to_call[0].object_id = NodeId{0, id::ObjectsFolder};
    request.methods_to_call[0].method_id = own("start");
    request.methods_to_call[0].input_arguments = {Variant{std::int16_t{6}}};
    const auto sent = client->send(request);
    complete();
    const auto response = client->take<CallResponse>(sent);
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Bad_NotSupported);
    CHECK(plc->get<std::int16_t>("In") == 0);
    CHECK(plc->get<std::uint16_t>("H") == 0);
}

TEST_CASE_METHOD(MappedFixture, "8.3 Buffer memory: its values are Variables", "[8.3]")
{
    controller::ModuleStatus module{source, server, wall_clock};
    server.add_source(module);
    model::AddressSpace& space = server.address_space();
    const auto folder = space.find(NodeId{0, id::ObjectsFolder});
    REQUIRE(controller::add_module_status_nodes(space, folder, 1, module));
    plc->add("Speed", LabelType::Word, std::int16_t{4});
    const NodeId speed = add("speed", id::Int16, {"Speed"});
    plc->is_prompt = false;
    CHECK(read(own("TargetDevice1Status")).value == Variant{std::uint16_t{0}});
    source.start();
    CHECK(read(own("LabelUpdateRunningStatus")).value == Variant{std::uint16_t{1}});
    plc->is_prompt = true;
    plc->answer();
    CHECK(read(speed).status == status::Good);
    CHECK(read(own("LabelUpdateRunningStatus")).value == Variant{std::uint16_t{0}});
    CHECK(read(own("TargetDevice1Status")).value == Variant{std::uint16_t{1}});
    CHECK(read(own("RevisedSamplingIntervalMinimum")).value == Variant{std::uint32_t{0}});
    CHECK(read(own("ActualSamplingIntervalMinimum")).value == Variant{std::uint32_t{0}});
}

} // namespace mapped_nodes_test
