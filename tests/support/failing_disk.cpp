#include "support/failing_disk.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <limits>
#include <map>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace busbar::test::failing_disk {

namespace {

enum class AtTheEnd { Dark, Kill, FailOnce };

/// What was written to a file and may be lost.
struct Written {
    off_t size_before{0};
    off_t bytes{0};
};

struct Disk {
    AtTheEnd at_the_end{AtTheEnd::Dark};
    std::size_t steps{0};
    std::size_t end{std::numeric_limits<std::size_t>::max()};
    bool is_dark{false};
    bool are_two{false};
    std::size_t reads{0};
    std::vector<std::size_t> calls;
    std::map<int, std::string> open_files;
    std::map<std::string, Written> unsynchronised;
};

Disk disk;
Orders* orders{nullptr};

[[noreturn]] void end_here()
{
    ::kill(::getpid(), SIGKILL);
    for (;;) {
        ::pause();
    }
}

enum class Fate { Done, Failed, Killed };

Fate next_fate()
{
    const std::uint64_t number = orders->calls++;
    if (number >= orders->killed_at) {
        return Fate::Killed;
    }
    if (number >= orders->fails_from && number < orders->fails_until) {
        errno = orders->error;
        return Fate::Failed;
    }
    return Fate::Done;
}

bool takes_order()
{
    const Fate fate = next_fate();
    if (fate == Fate::Killed) {
        end_here();
    }
    return fate == Fate::Done;
}

/// False if the call must fail.
bool takes_step()
{
    if (orders != nullptr) {
        return takes_order();
    }
    if (disk.is_dark) {
        errno = EIO;
        return false;
    }
    disk.calls.push_back(disk.steps);
    if (disk.steps++ != disk.end) {
        return true;
    }
    switch (disk.at_the_end) {
    case AtTheEnd::Kill:
        ::kill(::getpid(), SIGKILL);
        break;
    case AtTheEnd::Dark:
        disk.is_dark = true;
        errno = EIO;
        break;
    case AtTheEnd::FailOnce:
        errno = ENOSPC;
        break;
    }
    return false;
}

void start(AtTheEnd what, std::size_t end)
{
    disk.at_the_end = what;
    disk.steps = 0;
    disk.end = end;
    disk.is_dark = false;
    disk.calls.clear();
    disk.open_files.clear();
    disk.unsynchronised.clear();
}

void stop()
{
    start(AtTheEnd::Dark, std::numeric_limits<std::size_t>::max());
}

void lose_unsynchronised()
{
    for (const auto& [path, written] : disk.unsynchronised) {
        static_cast<void>(::truncate(path.c_str(), written.size_before + written.bytes / 2));
    }
}

} // namespace

Steps steps_of(const Operation& operation)
{
    stop();
    operation();
    return {disk.steps, std::exchange(disk.calls, {})};
}

void run_until_dark(std::size_t steps, const Operation& operation)
{
    start(AtTheEnd::Dark, steps);
    operation();
    lose_unsynchronised();
    stop();
}

bool run_until_killed(std::size_t steps, const Operation& operation)
{
    const pid_t child = ::fork();
    if (child == 0) {
        start(AtTheEnd::Kill, steps);
        operation();
        ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
}

void run_with_failure(std::size_t step, const Operation& operation)
{
    start(AtTheEnd::FailOnce, step);
    operation();
    stop();
}

void set_two_disks(bool are_two)
{
    disk.are_two = are_two;
}

std::size_t count_of_reads()
{
    return disk.reads;
}

void obey(Orders& all)
{
    orders = &all;
}

} // namespace busbar::test::failing_disk

using busbar::test::failing_disk::AtTheEnd;
using busbar::test::failing_disk::disk;
using busbar::test::failing_disk::end_here;
using busbar::test::failing_disk::Fate;
using busbar::test::failing_disk::next_fate;
using busbar::test::failing_disk::orders;
using busbar::test::failing_disk::takes_order;
using busbar::test::failing_disk::takes_step;

namespace {

/// Where it lies on a disk: pipes and the like do not count.
bool is_file(int descriptor)
{
    struct stat facts = {};
    return ::fstat(descriptor, &facts) == 0 && S_ISREG(facts.st_mode);
}

} // namespace

extern "C" {

int __real_open(const char* path, int flags, ...);
ssize_t __real_write(int file, const void* bytes, size_t size);
int __real_rename(const char* from, const char* to);
int __real_unlink(const char* path);
int __real_fchmod(int file, mode_t mode);

int __wrap_open(const char* path, int flags, ...)
{
    if ((flags & O_CREAT) == 0 && orders != nullptr) {
        const bool changes = (flags & O_ACCMODE) != O_RDONLY;
        return changes && !takes_order() ? -1 : __real_open(path, flags);
    }
    if ((flags & O_CREAT) == 0) {
        const int file = __real_open(path, flags);
        if ((flags & (O_ACCMODE | O_DIRECTORY)) == O_RDONLY) {
            ++disk.reads;
        } else if ((flags & O_ACCMODE) != O_RDONLY && file >= 0) {
            struct stat facts = {};
            disk.open_files[file] = path;
            disk.unsynchronised[path].size_before = ::fstat(file, &facts) == 0 ? facts.st_size : 0;
        }
        return file;
    }
    va_list rest;
    va_start(rest, flags);
    const auto mode = static_cast<mode_t>(va_arg(rest, unsigned));
    va_end(rest);
    if (!takes_step()) {
        return -1;
    }
    const int file = __real_open(path, flags, mode);
    if (file >= 0 && orders == nullptr) {
        disk.open_files[file] = path;
        disk.unsynchronised[path] = {};
    }
    return file;
}

ssize_t __wrap_write(int file, const void* bytes, size_t size)
{
    if (orders != nullptr) {
        const Fate fate = is_file(file) ? next_fate() : Fate::Done;
        if (fate == Fate::Killed) {
            static_cast<void>(__real_write(file, bytes, size / 2));
            end_here();
        }
        return fate == Fate::Failed ? -1 : __real_write(file, bytes, size);
    }
    const std::size_t left = disk.is_dark ? 0 : disk.end - std::min(disk.end, disk.steps);
    const std::size_t allowed = std::min(size, left);
    if (allowed == 0) {
        takes_step();
        return -1;
    }
    const ssize_t written = __real_write(file, bytes, allowed);
    for (const std::size_t byte : {std::size_t{0}, std::size_t{1}, allowed - 1}) {
        disk.calls.push_back(disk.steps + byte);
    }
    disk.steps += allowed;
    if (const auto known = disk.open_files.find(file); known != disk.open_files.end()) {
        disk.unsynchronised[known->second].bytes += written;
    }
    if (allowed < size && disk.at_the_end == AtTheEnd::Kill) {
        takes_step();
    }
    return written; // short where the end is: the next call fails
}

int __wrap_fsync(int file)
{
    if (!takes_step()) {
        return -1;
    }
    if (orders != nullptr) {
        return 0;
    }
    if (const auto known = disk.open_files.find(file); known != disk.open_files.end()) {
        disk.unsynchronised.erase(known->second);
        disk.open_files.erase(known);
    }
    return 0;
}

int __wrap_rename(const char* from, const char* to)
{
    if (disk.are_two) {
        // Giving a new file its name stays on one disk.
        const std::string source{from};
        if (source.substr(0, source.rfind('/')) !=
            std::string{to}.substr(0, std::string{to}.rfind('/'))) {
            errno = EXDEV;
            return -1;
        }
    }
    if (!takes_step()) {
        return -1;
    }
    if (orders != nullptr) {
        return __real_rename(from, to);
    }
    if (const auto found = disk.unsynchronised.find(from); found != disk.unsynchronised.end()) {
        disk.unsynchronised[to] = found->second;
        disk.unsynchronised.erase(from);
    }
    return __real_rename(from, to);
}

int __wrap_unlink(const char* path)
{
    return takes_step() ? __real_unlink(path) : -1;
}

int __wrap_fchmod(int file, mode_t mode)
{
    return takes_step() ? __real_fchmod(file, mode) : -1;
}

} // extern "C"
