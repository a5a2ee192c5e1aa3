#include "memory_return.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include <unistd.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace busbar::net::detail {

ProcessMemory process_memory()
{
    ProcessMemory memory;
#if defined(__GLIBC__)
#if __GLIBC_PREREQ(2, 33)
    memory.free = ::mallinfo2().fordblks;
    std::ifstream file{"/proc/self/statm"};
    std::size_t size = 0;
    std::size_t resident = 0;
    if (file >> size >> resident) {
        memory.resident = resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    }
#endif
#endif
    return memory;
}

void keep_free_memory()
{
#if defined(__GLIBC__)
    // A user who chose something in the environment keeps it. Older versions refuse to keep more,
    // and setting the other threshold alone would take more system calls than before.
    constexpr int most = 32 << 20;
    if (std::getenv("MALLOC_MMAP_THRESHOLD_") == nullptr) {
        ::mallopt(M_MMAP_THRESHOLD, most);
    }
    if (std::getenv("MALLOC_TRIM_THRESHOLD_") == nullptr) {
        ::mallopt(M_TRIM_THRESHOLD, most);
    }
#endif
}

void return_free_memory()
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

void MemoryReturn::look(TimePoint now)
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
