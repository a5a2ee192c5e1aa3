#include "memory_return.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>

#include <fcntl.h>
#include <unistd.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace busbar::net::detail {

#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
namespace {

/// Returns the second number of /proc/self/statm; takes no memory.
std::size_t resident_pages()
{
    const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    if (file < 0) {
        return 0;
    }
    std::array<char, 128> text{};
    const ssize_t size = ::read(file, text.data(), text.size());
    ::close(file);
    const char* const end = text.data() + std::max<ssize_t>(size, 0);
    const char* const second = std::find(static_cast<const char*>(text.data()), end, ' ');
    std::size_t pages = 0;
    if (second != end) {
        std::from_chars(second + 1, end, pages);
    }
    return pages;
}

} // namespace
#endif

ProcessMemory process_memory() noexcept
{
    ProcessMemory memory;
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
    memory.free = ::mallinfo2().fordblks;
    memory.resident = resident_pages() * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
#endif
    return memory;
}

void keep_free_memory()
{
#if defined(__GLIBC__)
    // A user who chose something in the environment keeps it. Older versions refuse to keep more,
    // and setting the other threshold alone would take more system calls than before.
    constexpr int most = 32 << 20;
    if (std::getenv("MALLOC_MMAP_THRESHOLD_") == nullptr &&
        ::mallopt(M_MMAP_THRESHOLD, most) == 0) {
        return;
    }
    if (std::getenv("MALLOC_TRIM_THRESHOLD_") == nullptr) {
        ::mallopt(M_TRIM_THRESHOLD, most);
    }
#endif
}

void return_free_memory() noexcept
{
#if defined(__GLIBC__)
    ::malloc_trim(0);
#endif
}

bool MemoryReturn::handle_deadline(TimePoint now, const ProcessMemory& memory)
{
    if (now < deadline_) {
        return false;
    }
    deadline_ = no_deadline;
    left_.resident = std::min(left_.resident, memory.resident);
    left_.free = std::min(left_.free, memory.free);
    return memory.free >= least &&
           (memory.resident - left_.resident >= least || memory.free - left_.free >= least);
}

void MemoryReturn::look(TimePoint now) noexcept
{
    if (deadline_ == no_deadline || now < deadline_) {
        return;
    }
    if (handle_deadline(now, process_memory())) {
        return_free_memory();
        returned(process_memory());
    }
}

} // namespace busbar::net::detail
