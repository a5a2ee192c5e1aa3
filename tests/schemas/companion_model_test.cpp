#include <catch2/catch.hpp>

#include <string>

#include <busbar/di/ids.hpp>
#include <busbar/di/nodes.hpp>
#include <busbar/model/plcopen.hpp>
#include <busbar/plcopen/ids.hpp>
#include <busbar/plcopen/nodes.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::model::companion_model_test {

namespace {

/// The constants that the builders name their types by are those of the published files.
static_assert(di_id::TopologyElementType == di::id::TopologyElementType);
static_assert(di_id::DeviceType == di::id::DeviceType);
static_assert(di_id::FunctionalGroupType == di::id::FunctionalGroupType);
static_assert(di_id::DeviceSet == di::id::DeviceSet);
static_assert(plcopen_id::CtrlConfigurationType == plcopen::id::CtrlConfigurationType);
static_assert(plcopen_id::CtrlResourceType == plcopen::id::CtrlResourceType);
static_assert(plcopen_id::CtrlProgramOrganizationUnitType ==
              plcopen::id::CtrlProgramOrganizationUnitType);
static_assert(plcopen_id::CtrlProgramType == plcopen::id::CtrlProgramType);
static_assert(plcopen_id::CtrlFunctionBlockType == plcopen::id::CtrlFunctionBlockType);
static_assert(plcopen_id::CtrlTaskType == plcopen::id::CtrlTaskType);
static_assert(plcopen_id::HasInputVar == plcopen::id::HasInputVar);
static_assert(plcopen_id::HasOutputVar == plcopen::id::HasOutputVar);
static_assert(plcopen_id::HasInOutVar == plcopen::id::HasInOutVar);
static_assert(plcopen_id::HasLocalVar == plcopen::id::HasLocalVar);
static_assert(plcopen_id::HasExternalVar == plcopen::id::HasExternalVar);
static_assert(plcopen_id::With == plcopen::id::With);

struct CompanionFixture {
    AddressSpace space;
    std::uint16_t ns{space.add_namespace("urn:plc").value()};
    Nameplate nameplate;

    CompanionFixture()
    {
        REQUIRE(space.add(di::nodes()));
        REQUIRE(space.add(plcopen::nodes()));
        nameplate.manufacturer = LocalizedText{"Acme"};
        nameplate.model = LocalizedText{"P4"};
        nameplate.serial_number = "4711";
        nameplate.product_code = "P4-1000";
    }
    [[nodiscard]] QualifiedName name(const char* text) const { return {ns, text}; }
    [[nodiscard]] NewNode named(const char* text) const
    {
        NewNode node;
        node.id = NodeId{ns, text};
        node.browse_name = name(text);
        return node;
    }
    [[nodiscard]] NodeIndex find(const char* id) const { return space.find(NodeId{ns, id}); }
    [[nodiscard]] Variant value(NodeIndex from, const char* path) const
    {
        const NodeIndex node = find_by_path(space, from, path);
        INFO(path);
        REQUIRE(node != no_node);
        return space.value(node);
    }
    /// The type of the reference from one node to the other.
    [[nodiscard]] NodeIndex reference(NodeIndex from, NodeIndex to) const
    {
        ReferenceCursor cursor = space.references(from);
        while (const auto each = cursor.next()) {
            if (each->is_forward && each->target == to) {
                return each->type;
            }
        }
        return no_node;
    }
    static NewVariable bool_variable()
    {
        NewVariable variable;
        variable.data_type = NodeId{0, id::Boolean};
        variable.value = Variant{false};
        return variable;
    }
    template <typename T>
    static StatusCode status_of(const Result<T>& result)
    {
        return result ? status::Good : result.error();
    }
};

} // namespace

TEST_CASE_METHOD(CompanionFixture, "Every reference of DI and PLCopen leads somewhere")
{
    for (const StaticNodes& nodes : {di::nodes(), plcopen::nodes()}) {
        CHECK(nodes.nodes.size() > 90);
        for (const StaticIdentifier& external : nodes.externals) {
            const StaticText uri = nodes.namespaces[external.namespace_index];
            const auto index = space.namespace_index(nodes.text.substr(uri.offset, uri.size));
            REQUIRE(index);
            INFO(*index << ' ' << external.value);
            CHECK(space.find(NodeId{*index, external.value}) != no_node);
        }
    }
}

TEST_CASE_METHOD(CompanionFixture, "A device has its nameplate in the DeviceSet")
{
    NewNode type_node = named("PressType");
    type_node.parent = find_di(space, di_id::DeviceType);
    const NodeIndex type = space.add_object_type(type_node).value();
    const NodeIndex press = add_device(space, named("Press"), type, nameplate).value();
    CHECK(reference(find_di(space, di_id::DeviceSet), press) == space.find(id::HasComponent));
    CHECK(value(press, "Manufacturer") == Variant{LocalizedText{"Acme"}});
    CHECK(value(press, "SerialNumber") == Variant{"4711"});
    CHECK(value(press, "RevisionCounter") == Variant{std::int32_t{-1}});
    CHECK(value(press, "ProductCode") == Variant{"P4-1000"});
    CHECK(find_by_path(space, press, "DeviceClass") == no_node);

    SECTION("parameters are organized by groups")
    {
        const NodeIndex group = add_functional_group(space, press, name("Tuning")).value();
        const NodeIndex parameter =
            add_parameter(space, press, group, name("Gain"), bool_variable()).value();
        CHECK(find("Press/ParameterSet/Gain") == parameter);
        CHECK(find_by_path(space, press, "Tuning/Gain") == parameter);
        CHECK(add_parameter(space, press, no_node, name("Offset"), bool_variable()));
    }
    SECTION("an abstract type is refused")
    {
        CHECK(status_of(add_device(space, named("Other"), find_di(space, di_id::DeviceType),
                                   nameplate)) == status::Bad_TypeDefinitionInvalid);
    }
    SECTION("an AddressSpace without DI has no devices")
    {
        AddressSpace empty;
        CHECK(status_of(add_device(empty, NewNode{}, empty.find(id::BaseObjectType), nameplate)) ==
              status::Bad_TypeDefinitionInvalid);
    }
}

TEST_CASE_METHOD(CompanionFixture, "A controller is built from a few lines")
{
    const NodeIndex plc = add_ctrl_configuration(space, named("Plc")).value();
    const NodeIndex cpu = add_ctrl_resource(space, plc, name("Cpu"), nameplate).value();
    CtrlTask cyclic;
    cyclic.priority = 1;
    cyclic.interval = "T#1ms";
    const NodeIndex task = add_ctrl_task(space, cpu, name("Fast"), cyclic).value();
    const NodeIndex timer = add_function_block_type(space, name("Timer")).value();
    REQUIRE(add_pou_variable(space, timer, PouVariable::Output, name("Q"), bool_variable()));
    const NodeIndex main_type = add_program_type(space, name("Main")).value();
    REQUIRE(add_pou_variable(space, main_type, PouVariable::Input, name("Start"), bool_variable()));
    REQUIRE(add_function_block(space, main_type, name("Delay"), timer));
    const NodeIndex program = add_program(space, cpu, name("Main1"), main_type, task).value();

    CHECK(reference(find_di(space, di_id::DeviceSet), plc) == space.find(id::HasComponent));
    CHECK(find("Plc/Resources/Cpu") == cpu);
    CHECK(value(cpu, "SerialNumber") == Variant{"4711"});
    CHECK(find("Plc/Resources/Cpu/Tasks/Fast") == task);
    CHECK(value(task, "Priority") == Variant{std::uint32_t{1}});
    CHECK(value(task, "Interval") == Variant{"T#1ms"});
    CHECK(find_by_path(space, task, "Single") == no_node);
    CHECK(find("Plc/Resources/Cpu/Programs/Main1") == program);
    CHECK(space.type_definition(program) == main_type);
    CHECK(reference(program, task) == find_plcopen(space, plcopen_id::With));
    const NodeIndex start = find_by_path(space, program, "Start");
    REQUIRE(start != no_node);
    CHECK(reference(program, start) == find_plcopen(space, plcopen_id::HasInputVar));
    const NodeIndex delay = find_by_path(space, program, "Delay");
    REQUIRE(delay != no_node);
    CHECK(space.type_definition(delay) == timer);
    CHECK(find_by_path(space, delay, "Q") != no_node);

    SECTION("with global variables")
    {
        const NodeIndex global =
            add_global_variable(space, cpu, name("Emergency"), bool_variable()).value();
        CHECK(find("Plc/Resources/Cpu/GlobalVars/Emergency") == global);
        CHECK(add_global_variable(space, plc, name("Emergency"), bool_variable()));
        REQUIRE(add_external_variable(space, program, global));
        CHECK(find_by_path(space, program, "Emergency") == global);
    }
    SECTION("and nothing in the wrong place")
    {
        const StatusCode refused = status::Bad_TypeDefinitionInvalid;
        CHECK(status_of(add_ctrl_task(space, plc, name("Slow"), cyclic)) == refused);
        CHECK(status_of(add_ctrl_resource(space, cpu, name("Cpu2"), nameplate)) == refused);
        CHECK(status_of(add_program(space, cpu, name("Main2"), timer)) == refused);
        CHECK(status_of(add_function_block(space, plc, name("Delay"), timer)) == refused);
        CHECK(status_of(add_pou_variable(space, cpu, PouVariable::Local, name("X"),
                                         bool_variable())) == refused);
        CHECK(status_of(add_global_variable(space, task, name("X"), bool_variable())) == refused);
    }
}

} // namespace busbar::model::companion_model_test
