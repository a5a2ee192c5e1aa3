#include <busbar/controller/mapping_table.hpp>
#include <busbar/controller/node_roles.hpp>

#include "mapping_fixture.hpp"

namespace node_roles_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

const std::string permissions = "<RolePermissions><RolePermission Permissions=\"97\">i=15680"
                                "</RolePermission></RolePermissions>";

struct RolesFixture : ModelFixture {
    RolesFixture()
    {
        import(file("urn:t", cell() + variable("s=A", {}, "DataType=\"i=6\" AccessLevel=\"3\"") +
                                 variable("s=B") + method("s=M")));
    }
    void set(const std::string& name, const std::string& roles)
    {
        const auto parsed = parse_roles(roles);
        REQUIRE(parsed);
        models.set_roles(models.space().find(id(name)), *parsed);
    }
    /// Of the node in a server's AddressSpace.
    [[nodiscard]] std::string served(const std::string& name) const
    {
        model::AddressSpace space;
        REQUIRE(models.load_into(space));
        const auto index = space.namespace_index("urn:t");
        REQUIRE(index);
        const model::NodeIndex node = space.find(NodeId{*index, String{name}});
        REQUIRE(node != model::no_node);
        const auto* const roles = space.role_permissions(node);
        return roles == nullptr ? "everybody" : roles_text(roles->span());
    }
};

std::string problem_in(std::string_view text)
{
    const auto roles = parse_roles(text);
    return roles ? std::string{} : busbar::text(roles.error());
}

} // namespace

TEST_CASE("Roles of nodes are texts that can be read again", "[roles]")
{
    for (const char* const text :
         {"Operator=write", "Observer=read Operator=write+call", "Anonymous=browse", "none",
          "SecurityAdmin=all", "Engineer=4147", "ns=1;s=Fitter=read", "Supervisor=0"}) {
        const auto roles = parse_roles(text);
        REQUIRE(roles);
        CHECK(roles_text(roles->span()) == text);
        CHECK_FALSE(roles->is_null());
    }
    const auto operators = parse_roles("  Operator=read+write ");
    REQUIRE(operators);
    CHECK(roles_text(operators->span()) == "Operator=write");

    CHECK(problem_in("").find("found nothing") != std::string::npos);
    CHECK(problem_in("Operator").find("found no right") != std::string::npos);
    CHECK(problem_in("Operator=").find("found no right") != std::string::npos);
    CHECK(problem_in("Operater=read").find("found no such role, expected one of Anonymous") !=
          std::string::npos);
    CHECK(problem_in("Operator=wrote").find("found wrote, expected browse, read") !=
          std::string::npos);
    CHECK(problem_in("Operator=read+").find("expected browse, read") != std::string::npos);
    CHECK(problem_in("Operator=4294967296").find("found 4294967296") != std::string::npos);
    CHECK(problem_in("Operator=read Operator=call").find("found it twice") != std::string::npos);
}

TEST_CASE_METHOD(RolesFixture, "Roles of nodes are those of the file and of the server", "[roles]")
{
    set("A", "Operator=write Anonymous=read");
    map("A", "a");
    CHECK(served("A") == "Operator=write Anonymous=read");
    CHECK(served("B") == "everybody");

    ModelFixture copy;
    copy.import(exported());
    const auto* const roles =
        copy.models.space().role_permissions(copy.models.space().find(copy.id("A")));
    REQUIRE(roles != nullptr);
    CHECK(roles_text(roles->span()) == "Operator=write Anonymous=read");
    CHECK(copy.label("A") == "a");

    set("A", "none");
    CHECK(served("A") == "none");
    models.set_roles(models.space().find(id("A")), {});
    CHECK(served("A") == "everybody");
    CHECK(exported().find("RolePermission") == std::string::npos);
}

TEST_CASE_METHOD(RolesFixture, "Roles of nodes stay when their file is imported again", "[roles]")
{
    set("A", "Operator=write");
    set("B", "Engineer=read");
    const ImportResult again =
        import(file("urn:t", variable("s=A") + variable("s=B", permissions)));
    CHECK(served("A") == "Operator=write");
    CHECK(served("B") == "Operator=97");
    CHECK(has(again.reports, ModelCode::RolesKept));
    CHECK(has(again.reports, ModelCode::RolesReplaced));

    import(file("urn:u", {}), "u.xml");
    REQUIRE(models.remove("urn:u"));
    CHECK(served("A") == "Operator=write");

    CHECK(import(exported()).reports.is_empty());
    CHECK(served("A") == "Operator=write");
}

TEST_CASE_METHOD(RolesFixture, "Roles of nodes are lines of a table", "[roles]")
{
    set("M", "Operator=call");
    set("Cell", "none");
    map("A", "a");
    const std::string table = write_mapping_table(models.space(), models.mapping());
    CHECK(table.find("s=M,/Objects/1:Cell/1:M,Roles,Operator=call,,,,\r\n") != std::string::npos);
    CHECK(table.find("s=Cell,/Objects/1:Cell,Roles,none,,,,\r\n") != std::string::npos);

    const auto back = read_mapping_table(table, models.space());
    CHECK(back.reports.is_empty());
    REQUIRE(back.roles.size() == 2);
    CHECK(back.mapping.methods.empty());
    CHECK(roles_text(back.roles[0].roles.span()) == "none");
    CHECK(back.roles[1].node == id("M"));

    const std::string head = "NodeId,Part,Label\n";
    CHECK(has(read_mapping_table(head + "ns=1;s=M,Roles,Operator=go\n", models.space()).reports,
              ModelCode::TableRoles));
    CHECK(has(read_mapping_table(head + "i=2253,Roles,none\n", models.space()).reports,
              ModelCode::TableRoles));
    CHECK(
        has(read_mapping_table(head + "ns=1;s=M,Roles,none\nns=1;s=M,Roles,none\n", models.space())
                .reports,
            ModelCode::TableRepeated));
}

TEST_CASE_METHOD(RolesFixture, "Roles of nodes are checked", "[roles]")
{
    set("A", "Operator=write");
    set("M", "Operator=call");
    CHECK(check_roles(models).is_empty());
    set("B", "Operator=write"); // cannot be written
    set("M", "Operator=write");
    set("A", "ns=1;s=Fitter=read");
    const ModelReports reports = check_roles(models);
    CHECK(reports.warning_count() == 3);
    CHECK_FALSE(reports.has_errors());
    CHECK(has(reports, ModelCode::RoleUnknown));
    CHECK(has(reports, ModelCode::RightUnused));
}

} // namespace node_roles_test
