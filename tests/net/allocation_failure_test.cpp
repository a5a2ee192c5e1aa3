#include <catch2/catch.hpp>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <functional>
#include <optional>
#include <string>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/write.hpp>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <busbar/harness/log_book.hpp>
#include <busbar/net/server_loop.hpp>

#include "channel/frame.hpp"
#include "channel/output_buffer.hpp"
#include "machine.hpp"
#include "support/failing_allocation.hpp"

namespace allocation_failure_test {

/// A loop that takes peers with the k-th of its allocations failing, for k = 1, 2, ... until it
/// goes well. Server and peers have one thread: the peers do their part in work that is posted.
using namespace busbar;
using asio::ip::tcp;

namespace {

/// Says Hello, and hears what comes of it.
class Visitor {
public:
    explicit Visitor(std::uint16_t port)
    {
        socket_.connect({asio::ip::address_v4::loopback(), port});
        channel::detail::OutputBuffer output;
        channel::detail::write_hello(output, {0, 65'535, 65'535, 0, 0, String{"opc.tcp://a:1"}});
        std::error_code ignored;
        asio::write(socket_, asio::buffer(output.output().data(), output.output().size()), ignored);
        socket_.non_blocking(true);
    }
    enum class End { Answered, Closed };
    [[nodiscard]] std::optional<End> end()
    {
        std::array<char, 64> bytes{};
        std::error_code error;
        const std::size_t size = socket_.read_some(asio::buffer(bytes), error);
        if (error == asio::error::would_block) {
            return std::nullopt;
        }
        return std::string_view{bytes.data(), size}.starts_with("ACK") ? End::Answered
                                                                       : End::Closed;
    }

private:
    asio::io_context context_;
    tcp::socket socket_{context_};
};

/// A loop that runs until the test has seen enough.
class Loop {
public:
    Loop()
    {
        server_.emplace(
            *server::Server::create(test::server_config(port_), {.random = &around_.random,
                                                                 .wall_clock = &around_.clock,
                                                                 .log = &log,
                                                                 .waker = &loop_.waker()}));
    }
    /// Calls `work`, in which nothing fails, again and again until it gives false.
    void run_while(std::function<bool()> work)
    {
        work_ = std::move(work);
        post();
        const test::Counted while_it_runs;
        loop_.run(*server_);
    }
    /// Calls `first` at the beginning, and `last` when it is told to stop.
    void run_until_signal(const std::function<void()>& first, const std::function<void()>& last)
    {
        loop_.stop_on_signals(last);
        loop_.post(first);
        const test::Counted while_it_runs;
        loop_.run(*server_);
    }
    [[nodiscard]] std::uint16_t port() const { return port_; }
    [[nodiscard]] bool has_stopped() const { return server_->is_stopped(); }

    harness::LogBook log;

private:
    void post()
    {
        loop_.post([this] {
            const test::Uncounted not_now;
            if (work_()) {
                post();
            } else {
                test::fail_allocation(0);
                loop_.stop();
            }
        });
    }

    test::ClientSurroundings around_;
    net::ServerLoop loop_{log};
    std::uint16_t port_{*loop_.listen("127.0.0.1", 0)};
    std::optional<server::Server> server_;
    std::function<bool()> work_;
};

/// Visits with some allocations failing, each followed by one with none.
class Visits {
public:
    Visits(Loop& loop, std::size_t most) : loop_{&loop}, most_{most} { begin(false); }

    /// True while there is more to do.
    [[nodiscard]] bool go_on()
    {
        const auto end = visitor_->end();
        if (!end) {
            is_stuck = std::chrono::steady_clock::now() > late_;
            return !is_stuck;
        }
        if (*end == Visitor::End::Closed) {
            ++closed;
        }
        if (!is_failing_) {
            is_served = is_served && *end == Visitor::End::Answered;
        } else if (!test::has_allocation_failed()) {
            return false;
        }
        begin(!is_failing_);
        return true;
    }

    std::size_t k{0};
    int closed{0};
    /// Who comes when there is memory again.
    bool is_served{true};
    /// Somebody heard neither yes nor no.
    bool is_stuck{false};

private:
    void begin(bool is_failing)
    {
        is_failing_ = is_failing;
        visitor_.emplace(loop_->port());
        late_ = std::chrono::steady_clock::now() + std::chrono::seconds{20};
        test::fail_allocation(is_failing ? ++k : 0, most_);
    }

    Loop* loop_;
    std::size_t most_;
    bool is_failing_{false};
    std::optional<Visitor> visitor_;
    std::chrono::steady_clock::time_point late_;
};

/// A process that knocks at a port, and does nothing else to the loop.
class Knocker {
public:
    static constexpr int visits = 8;

    explicit Knocker(std::uint16_t port)
    {
        channel::detail::OutputBuffer hello;
        channel::detail::write_hello(hello, {0, 65'535, 65'535, 0, 0, String{"opc.tcp://a:1"}});
        process_ = ::fork();
        REQUIRE(process_ >= 0);
        if (process_ == 0) {
            const bool is_served = knock(port, hello.output());
            ::kill(::getppid(), SIGTERM); // the loop has been there for long enough
            ::_exit(is_served ? 0 : 1);
        }
    }
    Knocker(const Knocker&) = delete;
    Knocker& operator=(const Knocker&) = delete;
    ~Knocker() { static_cast<void>(is_served()); }

    /// Waits for its end.
    [[nodiscard]] bool is_served()
    {
        int result = 1;
        while (process_ > 0 && ::waitpid(process_, &result, 0) < 0 && errno == EINTR) {
        }
        process_ = -1;
        return result == 0;
    }

private:
    /// True if it is answered so many times, however often it has to come for that.
    static bool knock(std::uint16_t port, std::span<const std::byte> hello)
    {
        constexpr int patience = 100;
        int answers = 0;
        for (int tries = 0; answers < visits && tries < patience; ++tries) {
            answers += is_answered(port, hello) ? 1 : 0;
        }
        return answers == visits;
    }
    static bool is_answered(std::uint16_t port, std::span<const std::byte> hello)
    {
        constexpr int patience_ms = 100;
        const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        std::array<char, 3> bytes{};
        pollfd input{socket, POLLIN, 0};
        const bool is_answered =
            ::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
            ::send(socket, hello.data(), hello.size(), MSG_NOSIGNAL) > 0 &&
            ::poll(&input, 1, patience_ms) == 1 &&
            ::recv(socket, bytes.data(), bytes.size(), 0) == 3 &&
            std::string_view{bytes.data(), bytes.size()} == "ACK";
        ::close(socket);
        return is_answered;
    }

    ::pid_t process_;
};

} // namespace

TEST_CASE("a loop that nothing else happens to takes peers again", "[net]")
{
    const std::size_t most = GENERATE(1U, 4U, 16U);
    for (std::size_t k = 1; k <= 40; ++k) {
        Loop loop;
        Knocker knocker{loop.port()};
        loop.run_until_signal([&] { test::fail_allocation(k, most); },
                              [] { test::fail_allocation(0); });
        INFO("with " << most << " that fail, the first of them no. " << k);
        REQUIRE(knocker.is_served());
    }
}

TEST_CASE("a loop that is told to stop without memory stops once there is some", "[net]")
{
    const std::size_t most = GENERATE(1U, 4U, 16U);
    for (std::size_t k = 1; k <= 8; ++k) {
        Loop loop;
        const Knocker knocker{loop.port()};
        loop.run_until_signal([] {}, [&] { test::fail_allocation(k, most); });
        test::fail_allocation(0);
        INFO("with " << most << " that fail, the first of them no. " << k);
        REQUIRE(loop.has_stopped());
    }
}

TEST_CASE("a loop takes peers again after an allocation that fails", "[net]")
{
    const std::size_t most = GENERATE(1U, 2U, 5U, 20U, 100U);
    Loop loop;
    Visits visits{loop, most};
    loop.run_while([&] { return visits.go_on(); });
    INFO("with " << most << " that fail, the first of them no. " << visits.k);
    CHECK_FALSE(visits.is_stuck);
    CHECK(visits.is_served);
    CHECK(visits.closed > 0);
    CHECK(visits.k > 10);
    CHECK((most != 1 || loop.log.contains("no memory"))); // else there is none for the log either
}

} // namespace allocation_failure_test
