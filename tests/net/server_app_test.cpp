#include <catch2/catch.hpp>

#include <csignal>
#include <fstream>
#include <thread>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/read.hpp>
#include <asio/write.hpp>
#include <unistd.h>

#include <busbar/net/server_app.hpp>
#include <busbar/types/ids.hpp>

#include "support/temporary_folder.hpp"

namespace server_app_test {

using namespace busbar;
using namespace busbar::test;

namespace {

net::ApplicationSettings settings_in(const TemporaryFolder& folder)
{
    return {"urn:example:app", "App", folder.path.string()};
}

/// A port that nobody listens on, and that the system gives to nobody who asks for any.
asio::ip::tcp::acceptor take_free_port(asio::io_context& context)
{
    asio::ip::tcp::acceptor acceptor{context, asio::ip::tcp::v4()};
    std::error_code error = asio::error::address_in_use;
    // Tests that run at the same time begin elsewhere.
    const auto first = static_cast<std::uint16_t>(20'000 + ::getpid() % 10'000);
    for (std::uint16_t port = first; error && port < 32'768; ++port) {
        acceptor.bind({asio::ip::address_v4::any(), port}, error);
    }
    REQUIRE_FALSE(error);
    return acceptor;
}

std::string url_of(std::uint16_t port)
{
    return "opc.tcp://localhost:" + std::to_string(port);
}

/// Until somebody answers at the port, who does not take what is said for a Hello.
void await_answer(std::uint16_t port)
{
    for (;;) {
        asio::io_context context;
        asio::ip::tcp::socket socket{context};
        std::error_code error;
        socket.connect({asio::ip::address_v4::loopback(), port}, error);
        std::string answer(8, ' ');
        asio::write(socket, asio::buffer("GET / HTTP/1.0\r\n\r\n", 18), error);
        asio::read(socket, asio::buffer(answer), error);
        if (answer.starts_with("ERRF")) {
            return;
        }
        std::this_thread::yield();
    }
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
        CHECK(first.where == "user \"operator\"");
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

TEST_CASE("a ServerApp runs until it gets a signal", "[net]")
{
    const TemporaryFolder folder;
    asio::io_context context;
    auto taken = take_free_port(context);
    const std::uint16_t port = taken.local_endpoint().port();
    net::ServerApp app{settings_in(folder), url_of(port)};
    app.add_user("operator", "a pass phrase");
    taken.close();
    int code = -1;
    std::thread thread{[&] { code = app.run(); }};
    await_answer(port);
    REQUIRE(std::raise(SIGTERM) == 0);
    thread.join();
    CHECK(code == 0);
    CHECK(app.status());
    CHECK(app.server()->is_stopped());
}

TEST_CASE("a ServerApp whose port is taken says which", "[net]")
{
    const TemporaryFolder folder;
    asio::io_context context;
    auto taken = take_free_port(context);
    taken.listen();
    const std::uint16_t port = taken.local_endpoint().port();
    net::ServerApp app{settings_in(folder), url_of(port)};
    REQUIRE(app.status());
    CHECK(app.run() == 1);
    REQUIRE_FALSE(app.status());
    CHECK(app.status().error().where == "port " + std::to_string(port));
    CHECK(app.status().error().status == status::Bad_CommunicationError);
    app.add_user("operator", "a pass phrase"); // nobody is to log in any more
    CHECK_FALSE(app.users().log_in("operator", "a pass phrase"));
}

TEST_CASE("a ServerApp without a folder for its certificate says so", "[net]")
{
    const TemporaryFolder folder;
    const std::string file = (folder.path / "file").string();
    std::ofstream{file} << "no folder\n";
    net::ServerApp app{{"urn:example:app", "App", file + "/pki"}};
    REQUIRE_FALSE(app.status());
    CHECK(app.status().error().where == "certificate folder \"" + file + "/pki\"");
    CHECK(app.server() == nullptr);
    CHECK(app.run() == 1);
}

TEST_CASE("a ServerApp has no more namespaces than an index can name", "[net]")
{
    const TemporaryFolder folder;
    net::ServerApp app{settings_in(folder)};
    int added = 0;
    while (app.add_namespace("urn:example:" + std::to_string(added)) != 0) {
        ++added;
    }
    CHECK(added >= 65'000);
    REQUIRE_FALSE(app.status());
    CHECK(app.status().error().where == "namespace \"urn:example:" + std::to_string(added) + "\"");
    CHECK(app.run() == 1);
}

TEST_CASE("a user without a good password is refused by name", "[net]")
{
    const TemporaryFolder folder;
    {
        net::ServerApp app{settings_in(folder), "opc.tcp://localhost:48400"};
        app.add_user("pat", nullptr);
        REQUIRE_FALSE(app.status());
        CHECK(text(app.status().error()).starts_with("user \"pat\": has no password. Set the "));
    }
    net::ServerApp app{settings_in(folder), "opc.tcp://localhost:48400"};
    app.add_user("pat", "short");
    REQUIRE_FALSE(app.status());
    CHECK(text(app.status().error()).starts_with("user \"pat\": password rules: "));
}

} // namespace server_app_test
