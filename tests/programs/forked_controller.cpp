#include "programs/forked_controller.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <new>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <busbar/product/controller.hpp>

#include "product/machine/simulated_runtime.hpp"

namespace busbar::test {

namespace {

using failing_disk::Orders;

/// What the process says first; after anything else there is no controller.
constexpr char serves = 'R';

Orders* shared_orders()
{
    void* const memory =
        ::mmap(nullptr, sizeof(Orders), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        throw std::runtime_error{"there is no memory to share"};
    }
    return ::new (memory) Orders;
}

void say(int pipe, const std::string& text)
{
    static_cast<void>(::write(pipe, text.data(), text.size()));
}

void redirect(const std::string& log)
{
    const int in = ::open("/dev/null", O_RDONLY);
    const int out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    ::dup2(in, STDIN_FILENO);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(out, STDERR_FILENO);
    std::setvbuf(stdout, nullptr, _IOLBF, 0); // the log has all lines before the power goes
}

/// In the process of its own, which ends with it. Nothing of the test is destroyed there.
[[noreturn]] void serve(const product::Configuration& configuration, Orders& orders, int pipe)
{
    failing_disk::obey(orders);
    product::SimulatedRuntime runtime;
    auto controller = product::Controller::create(configuration, runtime, {});
    if (!controller) {
        say(pipe, text(controller.error()));
        ::_exit(1);
    }
    say(pipe, std::string(1, serves));
    ::close(pipe);
    const auto ended = (*controller)->run();
    ::_exit(ended ? 0 : 1);
}

} // namespace

ForkedController::ForkedController(product::Configuration configuration, std::string log)
    : configuration_{std::move(configuration)}, log_{std::move(log)}, orders_{shared_orders()}
{
}

ForkedController::~ForkedController()
{
    kill();
    ::munmap(orders_, sizeof(Orders));
}

ForkedController::Start ForkedController::start()
{
    int pipe[2];
    if (::pipe2(pipe, O_CLOEXEC) != 0) {
        throw std::runtime_error{"there is no pipe"};
    }
    process_ = ::fork();
    if (process_ < 0) {
        throw std::runtime_error{"no process could be started"};
    }
    if (process_ == 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        ::setsid(); // a terminal that is closed is none of its business
        ::close(pipe[0]);
        redirect(log_);
        serve(configuration_, *orders_, pipe[1]);
    }
    ::close(pipe[1]);
    std::string said;
    char piece[4'096];
    for (ssize_t size = 0; (size = ::read(pipe[0], piece, sizeof piece)) > 0;) {
        said.append(piece, static_cast<std::size_t>(size));
    }
    ::close(pipe[0]);
    if (said == std::string(1, serves)) {
        return Start::Serves;
    }
    int status = 0;
    ::waitpid(process_, &status, 0); // its end of the pipe is closed by its end
    process_ = -1;
    why_not_ = said;
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL ? Start::Killed : Start::Refused;
}

void ForkedController::kill()
{
    if (process_ > 0) {
        ::kill(process_, SIGKILL);
        ::waitpid(process_, nullptr, 0);
        process_ = -1;
    }
}

void ForkedController::terminate()
{
    if (process_ > 0) {
        ::kill(process_, SIGTERM);
        ::waitpid(process_, nullptr, 0);
        process_ = -1;
    }
}

void ForkedController::hang_up() const
{
    if (process_ > 0) {
        ::kill(process_, SIGHUP);
    }
}

bool ForkedController::is_running()
{
    if (process_ > 0 && ::waitpid(process_, nullptr, WNOHANG) == process_) {
        process_ = -1;
    }
    return process_ > 0;
}

std::optional<ForkedController::Fault> ForkedController::draw_fault(harness::Chance& chance)
{
    Orders& orders = *orders_;
    const std::uint64_t now = orders.calls;
    if (chance.one_in(3)) {
        orders.killed_at = now + chance.below(25);
        return Fault{false,
                     "is to be killed in the call " + std::to_string(orders.killed_at - now)};
    }
    if (!chance.one_in(4)) {
        return std::nullopt;
    }
    orders.error = chance.pick({ENOSPC, EIO, EROFS, EACCES});
    orders.fails_until = now + 1'000'000;
    orders.fails_from = now + chance.below(20);
    if (chance.one_in(2)) {
        orders.fails_until = orders.fails_from + chance.pick<std::uint64_t>({1, 2, 5});
    }
    return Fault{true, "media fail with " + std::to_string(orders.error) + " from the call " +
                           std::to_string(orders.fails_from - now) + " to " +
                           std::to_string(orders.fails_until - now)};
}

void ForkedController::calm()
{
    orders_->killed_at = Orders::never;
    orders_->fails_from = Orders::never;
    orders_->fails_until = Orders::never;
}

} // namespace busbar::test
