#include <catch2/catch.hpp>

#include <busbar/net/server_app.hpp>
#include <busbar/types/ids.hpp>

#include "support/temporary_folder.hpp"

using namespace busbar;
using namespace busbar::test;

namespace {

net::ApplicationSettings settings_in(const TemporaryFolder& folder)
{
    return {"urn:example:app", "App", folder.path.string()};
}

} // namespace

TEST_CASE("a ServerApp has what was added to it", "[net]")
{
    const TemporaryFolder folder;
    net::ServerApp app{settings_in(folder), "opc.tcp://localhost:48400"};
    REQUIRE(app.status());
    app.add_user("operator", "a pass phrase");
    const std::uint16_t machine = app.add_namespace("urn:example:machine");
    const std::uint64_t speed =
        app.add_variable({machine, "Speed"}, 1480.0, model::Access::ReadWrite);
    app.add_variable({machine, "Levels"}, Array<std::int16_t>{1, 2});
    app.set(speed, 1500.0);
    REQUIRE(app.status());

    const model::AddressSpace& space = app.server()->address_space();
    const model::NodeIndex scalar = space.find(NodeId{machine, "Speed"});
    CHECK(space.data_type_id(scalar) == NodeId{0, id::Double});
    CHECK(space.variable(scalar).value_rank == -1);
    CHECK(space.variable(scalar).access_level == 3);
    const model::NodeIndex array = space.find(NodeId{machine, "Levels"});
    CHECK(space.data_type_id(array) == NodeId{0, id::Int16});
    CHECK(space.variable(array).value_rank == 1);
    CHECK(space.variable(array).array_dimensions[0] == 2);
    CHECK(space.variable(array).access_level == 1);
    CHECK(app.users().log_in("operator", "a pass phrase"));
}

TEST_CASE("a ServerApp owns the data sources that it makes", "[net]")
{
    struct Lasting final : server::DataSource {
        explicit Lasting(bool& told) : is_gone{told} {}
        ~Lasting() override { is_gone = true; }
        void read(server::ReadBatch batch) override { batch.fail(status::Bad_NoData); }
        bool& is_gone;
    };
    bool is_gone = false;
    const TemporaryFolder folder;
    {
        net::ServerApp app{settings_in(folder), "opc.tcp://localhost:48400"};
        auto& source = app.make_source<Lasting>(is_gone);
        CHECK(app.add_variable({1, "Level"}, source.variable(9, 0.0)) == 9);
        REQUIRE(app.status());
        const model::AddressSpace& space = app.server()->address_space();
        const auto level = space.variable(space.find(NodeId{1, "Level"}));
        CHECK(level.source == source.index());
        CHECK(level.handle == 9);
        CHECK_FALSE(is_gone);
    }
    CHECK(is_gone);
}

TEST_CASE("a ServerApp that failed still has its data sources", "[net]")
{
    struct Nothing final : server::DataSource {
        void read(server::ReadBatch batch) override { batch.fail(status::Bad_NoData); }
    };
    const TemporaryFolder folder;
    net::ServerApp app{settings_in(folder), "http://localhost"};
    REQUIRE_FALSE(app.status());
    auto& source = app.make_source<Nothing>();
    CHECK(source.index() == model::no_source);
    CHECK(app.add_variable({1, "Level"}, source.variable(9, 0.0)) == 0);
    CHECK(app.run() == 1);
}

TEST_CASE("a ServerApp keeps what failed first", "[net]")
{
    const TemporaryFolder folder;

    SECTION("no password")
    {
        net::ServerApp app{settings_in(folder)};
        app.add_user("operator", nullptr);
        REQUIRE_FALSE(app.status());
        const Problem first = app.status().error();
        CHECK(first.where == "password rules");
        CHECK(app.add_namespace("urn:example:machine") == 0);
        CHECK(text(app.status().error()) == text(first));
        CHECK(app.run() == 1);
    }
    SECTION("an URL that is none")
    {
        net::ServerApp app{settings_in(folder), "http://localhost"};
        REQUIRE_FALSE(app.status());
        CHECK(app.status().error().where == "endpoint_url");
        CHECK(app.server() == nullptr);
        app.set(app.add_variable({1, "Speed"}, 1.0), 2.0);
        CHECK(app.run() == 1);
    }
    SECTION("a variable twice")
    {
        net::ServerApp app{settings_in(folder)};
        app.add_variable({1, "Speed"}, 1.0);
        app.add_variable({1, "Speed"}, 1.0);
        REQUIRE_FALSE(app.status());
        CHECK(app.status().error().status == status::Bad_NodeIdExists);
    }
}
