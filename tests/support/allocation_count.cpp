#include "allocation_count.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> count{0};
std::atomic<std::size_t> bytes{0};
std::atomic<std::size_t> frees{0};
thread_local std::size_t calls{0};

void* allocate(std::size_t size)
{
    ++count;
    ++calls;
    bytes += size;
    return std::malloc(size == 0 ? 1 : size);
}

void* allocate_or_end(std::size_t size)
{
    void* const memory = allocate(size);
    if (memory == nullptr) {
        std::abort();
    }
    return memory;
}

void release(void* memory)
{
    frees += memory != nullptr ? 1 : 0;
    calls += memory != nullptr ? 1 : 0;
    std::free(memory);
}

} // namespace

std::size_t busbar::test::allocation_count()
{
    return count;
}

std::size_t busbar::test::free_count()
{
    return frees;
}

std::size_t busbar::test::calls_of_thread()
{
    return calls;
}

std::size_t busbar::test::allocated_bytes()
{
    return bytes;
}

// The other forms call these. No type here asks for more than malloc aligns to.
void* operator new(std::size_t size)
{
    return allocate_or_end(size);
}
void* operator new(std::size_t size, std::align_val_t)
{
    return allocate_or_end(size);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept
{
    return allocate(size);
}
void* operator new[](std::size_t size)
{
    return allocate_or_end(size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept
{
    return allocate(size);
}
void operator delete(void* memory) noexcept
{
    release(memory);
}
void operator delete(void* memory, std::size_t) noexcept
{
    release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept
{
    release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept
{
    release(memory);
}
void operator delete[](void* memory) noexcept
{
    release(memory);
}
void operator delete[](void* memory, std::size_t) noexcept
{
    release(memory);
}
