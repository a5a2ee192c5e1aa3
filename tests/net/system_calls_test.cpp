#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>

#include <dlfcn.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <sys/uio.h>
#include <unistd.h>

#include <busbar/net/blocking_client.hpp>
#include <busbar/types/subscription.hpp>

#include "machine.hpp"

namespace system_calls_test {

/// What a server asks of the system for a request. This program has functions of its own in the
/// place of those of the C library by which the loop does that; they count and go on there.
using namespace busbar;

namespace {

thread_local bool is_client = false;
std::atomic<long> calls_of_server{0};
std::atomic<long> timers_set_by_server{0};

template <typename Function, typename... Arguments>
auto counted(Function* next, Arguments... arguments)
{
    calls_of_server += is_client ? 0 : 1;
    return next(arguments...);
}

template <typename Function>
Function* library(Function* /*same*/, const char* name)
{
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

} // namespace

extern "C" {

int epoll_wait(int epoll, epoll_event* events, int most, int timeout)
{
    static auto* const next = library(&epoll_wait, "epoll_wait");
    return counted(next, epoll, events, most, timeout);
}
int epoll_ctl(int epoll, int operation, int descriptor, epoll_event* event) noexcept
{
    static auto* const next = library(&epoll_ctl, "epoll_ctl");
    return counted(next, epoll, operation, descriptor, event);
}
int timerfd_settime(int timer, int flags, const itimerspec* time, itimerspec* before) noexcept
{
    static auto* const next = library(&timerfd_settime, "timerfd_settime");
    timers_set_by_server += is_client ? 0 : 1;
    return counted(next, timer, flags, time, before);
}
int poll(pollfd* descriptors, nfds_t count, int timeout)
{
    static auto* const next = library(&poll, "poll");
    return counted(next, descriptors, count, timeout);
}
ssize_t recv(int socket, void* bytes, std::size_t size, int flags)
{
    static auto* const next = library(&recv, "recv");
    return counted(next, socket, bytes, size, flags);
}
ssize_t recvmsg(int socket, msghdr* message, int flags)
{
    static auto* const next = library(&recvmsg, "recvmsg");
    return counted(next, socket, message, flags);
}
ssize_t send(int socket, const void* bytes, std::size_t size, int flags)
{
    static auto* const next = library(&send, "send");
    return counted(next, socket, bytes, size, flags);
}
ssize_t sendmsg(int socket, const msghdr* message, int flags)
{
    static auto* const next = library(&sendmsg, "sendmsg");
    return counted(next, socket, message, flags);
}
ssize_t read(int descriptor, void* bytes, std::size_t size)
{
    static auto* const next = library(&read, "read");
    return counted(next, descriptor, bytes, size);
}
ssize_t write(int descriptor, const void* bytes, std::size_t size)
{
    static auto* const next = library(&write, "write");
    return counted(next, descriptor, bytes, size);
}
ssize_t readv(int descriptor, const iovec* parts, int count)
{
    static auto* const next = library(&readv, "readv");
    return counted(next, descriptor, parts, count);
}
ssize_t writev(int descriptor, const iovec* parts, int count)
{
    static auto* const next = library(&writev, "writev");
    return counted(next, descriptor, parts, count);
}

} // extern "C"

TEST_CASE("a request of one value takes four system calls of a server", "[net]")
{
    is_client = true;
    test::Machine machine;
    test::ClientSurroundings surroundings;
    net::BlockingClient client{test::client_config(machine.url()), surroundings.environment};
    REQUIRE(client.connect());
    const ReadRequest request = test::read_request(machine.node("Level"));
    const auto read = [&] {
        constexpr long requests = 20;
        const long before = calls_of_server;
        for (long i = 0; i < requests; ++i) {
            REQUIRE(client.call<ReadResponse>(request));
        }
        const double each = static_cast<double>(calls_of_server - before) / requests;
        INFO("calls of a request: " << each);
        CHECK(each >= 3); // to wait, to receive, to send: or they go another way than these
        return each;
    };
    // And to have the socket waited for again. A timer may come in between, though not each time.
    CHECK(std::min({read(), read(), read()}) <= 4.1);
}

TEST_CASE("a server sets no timer of the system for a Subscription that publishes", "[net]")
{
    is_client = true;
    test::Machine machine;
    test::ClientSurroundings surroundings;
    net::BlockingClient client{test::client_config(machine.url()), surroundings.environment};
    REQUIRE(client.connect());
    CreateSubscriptionRequest create;
    create.requested_publishing_interval = 50;
    create.requested_lifetime_count = 1'000;
    create.requested_max_keep_alive_count = 1; // a message each time
    create.publishing_enabled = true;
    REQUIRE(client.call<CreateSubscriptionResponse>(create));
    const auto publish = [&] {
        const long before = timers_set_by_server;
        for (int i = 0; i < 5; ++i) {
            REQUIRE(client.call<PublishResponse>(PublishRequest{}));
        }
        return timers_set_by_server - before;
    };
    CHECK(timers_set_by_server != 0); // or they are set another way than is counted here
    // It may set one for another reason meanwhile, as for the end of the connection.
    CHECK(std::min({publish(), publish(), publish()}) == 0);
}

} // namespace system_calls_test
