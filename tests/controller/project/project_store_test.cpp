#include <catch2/catch.hpp>

#include <span>
#include <string>

#include <busbar/controller/project_store.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "project_fixture.hpp"

namespace project_store_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

std::span<const std::byte> bytes_of(const std::string& text)
{
    return std::as_bytes(std::span{text});
}

std::string document_with_host(const std::string& host)
{
    Project project = test::press_project();
    project.network.host_name = host;
    return *document_of(project);
}

Configured<void> refuse_host_x(const Project& project)
{
    return project.network.host_name == "X" ? misconfigured("Press.xml:7: ns=1;i=5", "is wrong")
                                            : Configured<void>{};
}

struct StoreFixture {
    void restart()
    {
        store.emplace(storage, "project", refuse_host_x);
        REQUIRE(store->recover());
    }
    [[nodiscard]] std::string host() const
    {
        return store->current() != nullptr ? store->current()->network.host_name : "none";
    }

    storage::MemoryStorage storage;
    std::optional<ProjectStore> store{std::in_place, storage, "project", refuse_host_x};
};

} // namespace

TEST_CASE("9.13 Write and read: a project is transferred in parts and kept", "[9.13]")
{
    StoreFixture server;
    server.restart();
    CHECK(server.store->current() == nullptr);
    CHECK(server.store->document().error().status == status::Bad_NotFound);

    const std::string document = document_with_host("A");
    const auto transfer = server.store->begin();
    REQUIRE(transfer);
    for (std::size_t at = 0; at < document.size(); at += 100) {
        REQUIRE(server.store->write(*transfer, bytes_of(document.substr(at, 100))));
        CHECK(server.store->current() == nullptr);
    }
    REQUIRE(server.store->commit(*transfer));
    CHECK(server.host() == "A");
    CHECK(server.store->document().value() == document);

    server.restart();
    CHECK(server.host() == "A");
    REQUIRE(server.store->replace(bytes_of(document_with_host("B"))));
    CHECK(server.host() == "B");
    CHECK(server.storage.names() == std::vector<std::string>{"project/project.busbar"});
    CHECK_FALSE(server.storage.is_open_to_others("project/project.busbar"));
}

TEST_CASE("what a running store has need not be read again, and its transfer goes on")
{
    StoreFixture server;
    server.restart();
    REQUIRE(server.store->replace(bytes_of(document_with_host("A"))));
    const auto transfer = server.store->begin();
    REQUIRE(transfer);
    ProjectStore next{server.storage, "project", refuse_host_x};
    REQUIRE(next.recover(&*server.store));
    CHECK(next.current() == server.store->current());
    REQUIRE(server.store->write(*transfer, bytes_of(document_with_host("B"))));
    REQUIRE(server.store->commit(*transfer));
    CHECK(next.current()->network.host_name == "A"); // until it is read again
    ProjectStore after{server.storage, "project", refuse_host_x};
    REQUIRE(after.recover(&next));
    CHECK(after.current()->network.host_name == "B");
    // Nor is that of which nothing is known.
    ProjectStore last{server.storage, "project", refuse_host_x};
    const ProjectStore unread{server.storage, "project", refuse_host_x};
    REQUIRE(last.recover(&unread));
    CHECK(last.current()->network.host_name == "B");
    CHECK(last.current() != after.current());
}

TEST_CASE("what two stores of a folder stage at the same time does not meet")
{
    StoreFixture server;
    server.restart();
    ProjectStore next{server.storage, "project", refuse_host_x};
    REQUIRE(next.recover(&*server.store));
    {
        auto older = server.store->stage(bytes_of(document_with_host("A")));
        auto newer = next.stage(bytes_of(document_with_host("B")));
        REQUIRE(older);
        REQUIRE(newer);
        REQUIRE_FALSE(server.store->stage(bytes_of(document_with_host("X"))));
        REQUIRE(next.take_up(*std::move(newer)));
        ProjectStore read{server.storage, "project", refuse_host_x};
        REQUIRE(read.recover(&next));
        CHECK(read.current()->network.host_name == "B");
    }
    // What nobody takes up is gone, and after a power cut everything that was staged.
    CHECK(server.storage.list("project", 10)->entries.size() == 1);
    REQUIRE(server.storage.replace("project/project.part7", {}, FileAccess::Owner));
    server.restart();
    CHECK(server.storage.list("project", 10)->entries.size() == 1);
    CHECK(server.host() == "B");
}

TEST_CASE("9.13 Write: a project that is wrong in any part changes nothing", "[9.13]")
{
    StoreFixture server;
    server.restart();
    const std::string before = document_with_host("A");
    REQUIRE(server.store->replace(bytes_of(before)));
    std::string damaged = document_with_host("B");
    damaged[damaged.size() / 2] ^= 1;
    for (const auto& [document, problem] :
         {std::pair{damaged, "project:"},
          {document_with_host("a b"), "[network] host_name: "},
          {document_with_host("X"), "Press.xml:7: ns=1;i=5: is wrong"},
          {std::string{}, "project:1: found another file"}}) {
        const auto done = server.store->replace(bytes_of(document));
        REQUIRE_FALSE(done);
        CHECK(text(done.error()).starts_with(problem));
        CHECK(server.host() == "A");
        CHECK(server.store->document().value() == before);
        CHECK_FALSE(server.store->is_busy());
        CHECK(server.storage.names().size() == 1);
    }
}

TEST_CASE("9.13 Write: of two tools at once the second is refused", "[9.13]")
{
    StoreFixture server;
    server.restart();
    const auto first = server.store->begin();
    REQUIRE(first);
    const auto second = server.store->begin();
    REQUIRE_FALSE(second);
    CHECK(second.error().status == status::Bad_InvalidState);
    CHECK(text(second.error()).starts_with("transfer: another tool is writing a project"));
    // Neither by guessing a number.
    CHECK_FALSE(server.store->write(*first + 1, bytes_of("x")));
    CHECK_FALSE(server.store->commit(*first + 1));
    server.store->cancel(*first + 1);
    REQUIRE(server.store->write(*first, bytes_of(document_with_host("A"))));
    REQUIRE(server.store->commit(*first));
    CHECK(server.host() == "A");
    CHECK(server.store->begin());
}

TEST_CASE("9.13 Write: an interrupted transfer leaves the old project", "[9.13]")
{
    StoreFixture server;
    server.restart();
    REQUIRE(server.store->replace(bytes_of(document_with_host("A"))));
    const auto transfer = server.store->begin();
    REQUIRE(server.store->write(*transfer, bytes_of(document_with_host("B"))));
    SECTION("cancelled")
    {
        server.store->cancel(*transfer);
        CHECK_FALSE(server.store->write(*transfer, bytes_of("x")));
        CHECK(server.store->commit(*transfer).error().status == status::Bad_InvalidState);
    }
    SECTION("and the server restarted")
    {
        server.restart();
    }
    CHECK(server.host() == "A");
    CHECK(server.storage.names().size() == 1);
}

TEST_CASE("9.13 Write: more than the limit ends the transfer", "[9.13]")
{
    storage::MemoryStorage storage;
    ProjectStore store{storage, "project", {}, {.max_file_size = 1'000}};
    REQUIRE(store.recover());
    const auto transfer = store.begin();
    REQUIRE(store.write(*transfer, bytes_of(std::string(900, 'x'))));
    const auto more = store.write(*transfer, bytes_of(std::string(101, 'x')));
    REQUIRE_FALSE(more);
    CHECK(more.error().status == status::Bad_EncodingLimitsExceeded);
    CHECK_FALSE(store.is_busy());
    CHECK(storage.names().empty());
}

TEST_CASE("9.13 A project that cannot be read any more is said and can be replaced", "[9.13]")
{
    StoreFixture server;
    REQUIRE(server.storage.make_folder("project", FileAccess::Owner));
    REQUIRE(server.storage.replace("project/project.busbar", bytes_of("busbar project 7\n"),
                                   FileAccess::Owner));
    const auto recovered = server.store->recover();
    REQUIRE_FALSE(recovered);
    CHECK(text(recovered.error()) ==
          "project:1: found version 7, expected version 1; the file is of a newer program");
    CHECK(server.store->current() == nullptr);
    REQUIRE(server.store->replace(bytes_of(document_with_host("A"))));
    server.restart();
    CHECK(server.host() == "A");
}

} // namespace project_store_test
