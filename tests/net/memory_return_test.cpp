#include <catch2/catch.hpp>

#include <memory>
#include <vector>

#if defined(__GLIBC__)
#include <malloc.h>
#endif
#include <sys/resource.h>

#include <busbar/net/blocking_client.hpp>
#include <busbar/net/client_loop.hpp>

#include "machine.hpp"
#include "net/memory_return.hpp"

namespace memory_return_test {

using namespace busbar;
using net::detail::MemoryReturn;

namespace {

constexpr std::size_t mega = 1U << 20U;

/// Looks at the memory when it is time, and says whether it was given back.
struct Watched {
    bool look()
    {
        memory_return.note_activity(now);
        now = memory_return.next_deadline();
        return memory_return.handle_deadline(now, {resident, free});
    }
    void give_back(std::size_t bytes)
    {
        resident -= bytes;
        memory_return.returned({resident, free}); // malloc goes on counting it as free
    }

    MemoryReturn memory_return;
    TimePoint now{std::chrono::hours{1}};
    std::size_t resident{20 * mega};
    std::size_t free{0};
};

} // namespace

TEST_CASE("what a flood took is given back, once", "[memory_return]")
{
    Watched server;
    CHECK_FALSE(server.look()); // all of it is in use
    server.resident = 100 * mega;
    server.free = 80 * mega;
    CHECK(server.look());
    server.give_back(80 * mega);
    CHECK_FALSE(server.look());
    server.resident += MemoryReturn::least - 1;
    CHECK_FALSE(server.look());
    server.resident += 1; // the next flood takes what counts as free
    CHECK(server.look());
    server.give_back(0); // and this one is in use
    CHECK_FALSE(server.look());
    server.free += 10 * mega; // sessions end
    CHECK(server.look());
    server.give_back(10 * mega);
    server.free -= 10 * mega; // come again
    server.resident += MemoryReturn::least - 1;
    CHECK_FALSE(server.look());
    server.free += 10 * mega; // and end
    CHECK(server.look());
}

TEST_CASE("memory is looked at some time after something happened only", "[memory_return]")
{
    MemoryReturn memory_return;
    const net::detail::ProcessMemory flooded{100 * mega, 80 * mega};
    const TimePoint start{std::chrono::hours{1}};
    CHECK(memory_return.next_deadline() == no_deadline);
    memory_return.note_activity(start);
    memory_return.note_activity(start + std::chrono::seconds{1});
    CHECK(memory_return.next_deadline() == start + MemoryReturn::delay);
    CHECK_FALSE(memory_return.handle_deadline(start + std::chrono::seconds{1}, flooded));
    CHECK(memory_return.next_deadline() == start + MemoryReturn::delay);
    CHECK(memory_return.handle_deadline(start + MemoryReturn::delay, flooded));
    CHECK(memory_return.next_deadline() == no_deadline);
}

TEST_CASE("free memory can be given back at any time", "[memory_return]")
{
    static_cast<void>(net::detail::process_memory());
    net::detail::return_free_memory();
    CHECK(net::detail::process_memory().resident <= std::size_t{1} << 40U);
}

#if defined(__has_feature)
#define BUSBAR_HAS_OTHER_MALLOC __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define BUSBAR_HAS_OTHER_MALLOC 1
#else
#define BUSBAR_HAS_OTHER_MALLOC 0
#endif
#if defined(__GLIBC__) && !(BUSBAR_HAS_OTHER_MALLOC)
namespace {

/// Returns the page faults of as many small lists as a Browse of 10,000 nodes has.
long faults_of_request()
{
    rusage before{};
    rusage after{};
    ::getrusage(RUSAGE_SELF, &before);
    {
        std::vector<std::unique_ptr<char[]>> lists;
        for (int i = 0; i < 10'000; ++i) {
            lists.push_back(std::make_unique<char[]>(800));
        }
    }
    ::getrusage(RUSAGE_SELF, &after);
    return after.ru_minflt - before.ru_minflt;
}

/// Has malloc return what is freed, as in a process that has not begun a loop yet.
void forget_settings()
{
    ::mallopt(M_MMAP_THRESHOLD, 128 << 10);
    ::mallopt(M_TRIM_THRESHOLD, 128 << 10);
    ::malloc_trim(0);
}

} // namespace

TEST_CASE("what a large request freed is there for the next one", "[memory_return]")
{
    net::detail::keep_free_memory();
    static_cast<void>(faults_of_request());
    CHECK(faults_of_request() < 100); // of some 2,000 pages
    net::detail::return_free_memory();
    CHECK(faults_of_request() > 1'000);
}

TEST_CASE("a client has the memory of the last response for the next one", "[memory_return]")
{
    forget_settings();
    static_cast<void>(faults_of_request());
    REQUIRE(faults_of_request() > 1'000);
    test::ClientSurroundings surroundings;
    SECTION("with a session that comes back")
    {
        net::BlockingClient client{test::client_config("opc.tcp://127.0.0.1:4840"),
                                   surroundings.environment};
        static_cast<void>(faults_of_request());
        CHECK(faults_of_request() < 100);
    }
    SECTION("with one connection")
    {
        net::ClientLoop loop;
        static_cast<void>(faults_of_request());
        CHECK(faults_of_request() < 100);
    }
}

#endif

} // namespace memory_return_test
