#include "allocation_count.hpp"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include <malloc.h>

namespace {

std::atomic<std::size_t> count{0};
std::atomic<std::size_t> bytes{0};
std::atomic<std::size_t> frees{0};
std::atomic<std::size_t> held{0};
std::atomic<std::size_t> peak{0};
thread_local std::size_t calls{0};

/// What aligned_alloc gives has a multiple of the alignment, so that a sanitizer would not see what
/// lies behind the size.
void* take(std::size_t size, std::size_t alignment)
{
    if (alignment <= alignof(std::max_align_t)) {
        return std::malloc(size == 0 ? 1 : size);
    }
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void* allocate(std::size_t size, std::size_t alignment = alignof(std::max_align_t))
{
    ++count;
    ++calls;
    bytes += size;
    void* const memory = take(size, alignment);
    const std::size_t now = held += memory != nullptr ? ::malloc_usable_size(memory) : 0;
    for (std::size_t before = peak; before < now && !peak.compare_exchange_weak(before, now);) {
    }
    return memory;
}

void* allocate_or_end(std::size_t size, std::size_t alignment = alignof(std::max_align_t))
{
    void* const memory = allocate(size, alignment);
    if (memory == nullptr) {
        std::abort();
    }
    return memory;
}

void release(void* memory)
{
    frees += memory != nullptr ? 1 : 0;
    calls += memory != nullptr ? 1 : 0;
    held -= memory != nullptr ? ::malloc_usable_size(memory) : 0;
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

std::size_t busbar::test::held_bytes()
{
    return held;
}

std::size_t busbar::test::peak_bytes()
{
    return peak;
}

void busbar::test::forget_peak()
{
    peak = held.load();
}

// The other forms call these.
void* operator new(std::size_t size)
{
    return allocate_or_end(size);
}
void* operator new(std::size_t size, std::align_val_t alignment)
{
    return allocate_or_end(size, static_cast<std::size_t>(alignment));
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
