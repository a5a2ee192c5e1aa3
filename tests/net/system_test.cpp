#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/timex.h>
#include <unistd.h>

#include <busbar/net/system.hpp>

#include "support/temporary_folder.hpp"

namespace system_test {

using namespace busbar;

namespace {

/// What this process writes to the standard error output meanwhile.
class ErrorOutput {
public:
    ErrorOutput() : before_{::dup(STDERR_FILENO)}
    {
        std::fflush(stderr);
        const int file = ::open(path().c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
        REQUIRE(::dup2(file, STDERR_FILENO) >= 0);
        ::close(file);
    }
    ErrorOutput(const ErrorOutput&) = delete;
    ErrorOutput& operator=(const ErrorOutput&) = delete;
    ~ErrorOutput() { restore(); }

    [[nodiscard]] std::string take()
    {
        restore();
        std::ostringstream text;
        text << std::ifstream{path()}.rdbuf();
        return text.str();
    }

private:
    [[nodiscard]] std::string path() const { return (folder_.path / "output").string(); }
    void restore()
    {
        std::fflush(stderr);
        if (before_ >= 0) {
            ::dup2(before_, STDERR_FILENO);
            ::close(before_);
            before_ = -1;
        }
    }

    test::TemporaryFolder folder_;
    int before_;
};

int priority_of_this_thread()
{
    return ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()));
}

} // namespace

TEST_CASE("the log on the standard error output has lines of a level and above", "[net]")
{
    ErrorOutput output;
    net::StderrLog log{LogLevel::Warning};
    log.write(LogLevel::Debug, "net", "nothing to see");
    log.write(LogLevel::Info, "net", "nothing to see");
    log.write(LogLevel::Warning, "net", "look");
    log.write(LogLevel::Error, std::string_view{"network"}.substr(0, 3), "look again");
    net::StderrLog{}.write(LogLevel::Info, "channel", "open");
    net::StderrLog{LogLevel::Debug}.write(LogLevel::Debug, "channel", "closed");
    CHECK(output.take() == "warning: net: look\nerror: net: look again\ninfo: channel: open\n"
                           "debug: channel: closed\n");
}

TEST_CASE("a thread that gives way does so for itself and those that it makes", "[net]")
{
    const int before = priority_of_this_thread();
    int after = before;
    int of_child = before;
    std::thread{[&] {
        net::give_way();
        after = priority_of_this_thread();
        std::thread{[&] { of_child = priority_of_this_thread(); }}.join();
    }}.join();
    CHECK(after == std::min(before + 10, 19));
    CHECK(of_child == after);
    CHECK(priority_of_this_thread() == before);
}

TEST_CASE("the wall clock shows the time of day in the zone of the machine", "[net]")
{
    using Seconds = std::chrono::seconds;
    const auto seconds = [] {
        return std::chrono::duration_cast<Seconds>(
                   std::chrono::system_clock::now().time_since_epoch())
            .count();
    };
    const net::SystemWallClock clock;
    const auto earliest = seconds();
    const DateTime now = clock.now();
    CHECK(now.ticks >= DateTime::from_unix_seconds(earliest).ticks);
    CHECK(now.ticks <= DateTime::from_unix_seconds(seconds() + 1).ticks);
    CHECK(std::abs(clock.time_zone().offset) <= 14 * 60);
}

TEST_CASE("the clock follows a time service if the kernel says so", "[net]")
{
    timex state{};
    const bool is_synchronized =
        ::adjtimex(&state) != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
    CHECK(net::is_clock_synchronized() == is_synchronized);
}

} // namespace system_test
