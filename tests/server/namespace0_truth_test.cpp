#include <catch2/catch.hpp>

#include <array>
#include <map>
#include <set>

#include <busbar/types/method.hpp>

#include <nodes_of/embedded/nodes.hpp>
#include <nodes_of/full/nodes.hpp>
#include <nodes_of/micro/nodes.hpp>
#include <nodes_of/standard/nodes.hpp>

#include "diagnostics_fixture.hpp"

namespace namespace0_truth_test {

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr std::array sizes{micro_size::nodes, embedded_size::nodes, standard_size::nodes,
                           full_size::nodes};

/// Where models from files add roles and aliases: there without the Methods and Variables that the
/// features behind them would bring.
bool is_bare_container(const model::SpaceReader& space, model::NodeIndex type)
{
    return space.is_subtype_of(type, id::RoleSetType) || space.is_subtype_of(type, id::RoleType) ||
           space.is_subtype_of(type, id::AliasNameCategoryType);
}

/// Everything below Objects of a server with each size of namespace 0.
struct Crawl : DiagnosticsFixture {
    Crawl() : DiagnosticsFixture{model::AddressSpace{sizes[GENERATE(range(0U, 4U))]()}}
    {
        std::vector<model::NodeIndex> open{space.find(id::ObjectsFolder)};
        while (!open.empty()) {
            const model::NodeIndex node = open.back();
            open.pop_back();
            if (!nodes.insert(node).second) {
                continue;
            }
            if (space.node_class(node) == NodeClass::Variable) { // whose fields may come late
                static_cast<void>(children(admin, space.node_id(node)));
            }
            for (const model::NodeIndex child : children_of(node)) {
                parents.emplace(child, node);
                open.push_back(child);
            }
        }
    }
    [[nodiscard]] std::vector<model::NodeIndex> children_of(model::NodeIndex node) const
    {
        std::vector<model::NodeIndex> children;
        model::ReferenceCursor cursor = space.references(node);
        while (const auto reference = cursor.next()) {
            if (reference->is_forward &&
                space.is_subtype_of(reference->type, id::HierarchicalReferences)) {
                children.push_back(reference->target);
            }
        }
        return children;
    }
    [[nodiscard]] std::vector<model::NodeIndex> all_of(NodeClass node_class) const
    {
        std::vector<model::NodeIndex> found;
        std::copy_if(nodes.begin(), nodes.end(), std::back_inserter(found),
                     [&](model::NodeIndex node) { return space.node_class(node) == node_class; });
        return found;
    }
    [[nodiscard]] bool is_mandatory(model::NodeIndex declaration) const
    {
        model::ReferenceCursor cursor = space.references(declaration);
        while (const auto reference = cursor.next()) {
            if (reference->is_forward && reference->type == space.find(id::HasModellingRule)) {
                return reference->target == space.find(id::ModellingRule_Mandatory);
            }
        }
        return false;
    }
    [[nodiscard]] std::string text(model::NodeIndex node) const
    {
        return to_string(space.node_id(node)) + " " + space.browse_name(node).name.str();
    }

    model::AddressSpace& space{server.address_space()};
    TestClient admin{log_in_admin()};
    std::set<model::NodeIndex> nodes;
    std::map<model::NodeIndex, model::NodeIndex> parents;
};

} // namespace

TEST_CASE_METHOD(Crawl, "no Variable below Objects is Good with Null")
{
    const auto variables = all_of(NodeClass::Variable);
    CHECK(variables.size() > 30);
    for (const model::NodeIndex variable : variables) {
        const DataValue value = read(admin, space.node_id(variable));
        INFO(text(variable));
        CHECK((value.status.is_bad() || !value.value.is_null()));
    }
}

TEST_CASE_METHOD(Crawl, "every Method below Objects can be called")
{
    for (const model::NodeIndex method : all_of(NodeClass::Method)) {
        INFO(text(method));
        CHECK(space.attribute(method, AttributeId::Executable).value() == Variant{true});
        CallRequest request;
        request.methods_to_call.push_back(
            {space.node_id(parents.at(method)), space.node_id(method), {}});
        const auto response = admin.call<CallResponse>(request);
        REQUIRE(response);
        CHECK(response->results[0].status_code == status::Bad_ArgumentsMissing);
    }
}

TEST_CASE_METHOD(Crawl, "what is below Objects has the mandatory children of its type")
{
    std::size_t checked = 0;
    for (const model::NodeIndex node : nodes) {
        model::NodeIndex type = space.type_definition(node);
        if (is_bare_container(space, type)) {
            continue;
        }
        for (; type != model::no_node; type = space.supertype(type)) {
            for (const model::NodeIndex declaration : children_of(type)) {
                if (!is_mandatory(declaration)) {
                    continue;
                }
                const auto own = children_of(node);
                INFO(text(node) << " lacks " << text(declaration));
                CHECK(std::any_of(own.begin(), own.end(), [&](model::NodeIndex child) {
                    return space.browse_name(child) == space.browse_name(declaration);
                }));
                ++checked;
            }
        }
    }
    CHECK((checked > 20 || space.node_count() < 500));
}

TEST_CASE_METHOD(Crawl, "the folder of ModellingRules has those that there are")
{
    const model::NodeIndex folder = space.find(id::Server_ServerCapabilities_ModellingRules);
    const auto rules = children_of(folder);
    for (const std::uint32_t rule :
         {id::ModellingRule_Mandatory, id::ModellingRule_Optional,
          id::ModellingRule_ExposesItsArray, id::ModellingRule_OptionalPlaceholder,
          id::ModellingRule_MandatoryPlaceholder}) {
        const model::NodeIndex node = space.find(rule);
        INFO(rule);
        CHECK(std::count(rules.begin(), rules.end(), node) == (node != model::no_node ? 1 : 0));
    }
}

TEST_CASE_METHOD(Crawl, "the Server object tells when it is back after an end that is none",
                 "[unit:Base Info Estimated Return Time]")
{
    const auto back = [&] { return read(admin, id::Server_EstimatedReturnTime).value; };
    REQUIRE(back().get_if<DateTime>() != nullptr);
    CHECK(*back().get_if<DateTime>() <= wall_clock.time); // it is there
    server.begin_shutdown(now, "for good");
    CHECK(back() == Variant{DateTime{}}); // nobody knows
}

TEST_CASE_METHOD(Crawl, "the Server object tells what time it is where it stands",
                 "[unit:Base Info LocalTime]")
{
    const DataValue uris = read(admin, id::Server_UrisVersion);
    const DataValue local = read(admin, id::Server_LocalTime);
    if (server.address_space().find(id::Server_LocalTime) == model::no_node) {
        CHECK(uris.status == status::Bad_NodeIdUnknown); // a small namespace 0
        return;
    }
    const auto* object = local.value.get_if<ExtensionObject>();
    REQUIRE(object != nullptr);
    REQUIRE(object->get_if<TimeZoneDataType>() != nullptr);
    CHECK(*object->get_if<TimeZoneDataType>() == TimeZoneDataType{});
    CHECK(uris.value.value_or<std::uint32_t>(0) > 0);
    REQUIRE(server.address_space().add_namespace("urn:another"));
    CHECK(read(admin, id::Server_UrisVersion).value != uris.value);
}

TEST_CASE_METHOD(Crawl, "settings of security are for administrators")
{
    auto anonymous = log_in();
    auto user = log_in_as("operator");
    constexpr std::uint32_t security =
        id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionSecurityDiagnosticsArray;
    if (server.address_space().find(security) == model::no_node) {
        return; // micro
    }
    CHECK(enable(anonymous, false) == status::Bad_UserAccessDenied);
    CHECK(enable(user, false) == status::Bad_UserAccessDenied);
    CHECK(enable(admin, true) == status::Good);
    CHECK(read(user, security).status == status::Bad_NodeIdUnknown);
    CHECK(read(admin, security).status == status::Good);
    // AccessRestrictions: not even an administrator over a channel that can be overheard.
    TestClient overheard = connect("Basic256Sha256", MessageSecurityMode::Sign);
    REQUIRE(overheard.create_session(overheard.create_request()));
    REQUIRE(overheard.activate(overheard.user("admin", "admin-secret")) == status::Good);
    CHECK(read(overheard, security).status == status::Bad_SecurityModeInsufficient);
}

} // namespace namespace0_truth_test
