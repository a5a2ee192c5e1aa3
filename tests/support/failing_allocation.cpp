#include "failing_allocation.hpp"

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace {

bool is_counting{false};
std::size_t count{0};
std::size_t first_failing{0};
std::size_t last_failing{0};
std::size_t live{0};
std::size_t failing_size{0};

/// How many have failed; at its end the program says so.
struct Failures {
    Failures() = default;
    Failures(const Failures&) = delete;
    Failures& operator=(const Failures&) = delete;
    ~Failures()
    {
        if (count != 0) {
            std::printf("%zu allocations failed\n", count);
        }
    }

    std::size_t count{0};
};
Failures failures;

/// What aligned_alloc gives has a multiple of the alignment, so that a sanitizer would not see what
/// lies behind the size.
void* take(std::size_t size, std::size_t alignment)
{
    if (alignment <= alignof(std::max_align_t)) {
        return std::malloc(size == 0 ? 1 : size);
    }
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

/// Null if it is one of those that fail.
void* allocate(std::size_t size, std::size_t alignment = alignof(std::max_align_t)) noexcept
{
    const bool is_one_of_them = is_counting && ++count >= first_failing && count <= last_failing;
    if (is_one_of_them || (is_counting && failing_size != 0 && size >= failing_size)) {
        ++failures.count;
        return nullptr;
    }
    ++live;
    return take(size, alignment);
}

void* allocate_or_throw(std::size_t size, std::size_t alignment = alignof(std::max_align_t))
{
    void* const memory = allocate(size, alignment);
    if (memory == nullptr) {
        throw std::bad_alloc{};
    }
    return memory;
}

void release(void* memory) noexcept
{
    live -= memory != nullptr ? 1 : 0;
    std::free(memory);
}

} // namespace

void busbar::test::fail_allocation(std::size_t k, std::size_t most)
{
    count = 0;
    first_failing = k;
    last_failing = k == 0 ? 0 : k + most - 1;
}

void busbar::test::fail_large_allocations(std::size_t size)
{
    failing_size = size;
}

bool busbar::test::has_allocation_failed()
{
    return first_failing != 0 && count >= first_failing;
}

std::size_t busbar::test::live_allocations()
{
    return live;
}

busbar::test::Counted::Counted()
{
    is_counting = true;
}

busbar::test::Counted::~Counted()
{
    is_counting = false;
}

busbar::test::Uncounted::Uncounted() : was_counted_{is_counting}
{
    is_counting = false;
}

busbar::test::Uncounted::~Uncounted()
{
    is_counting = was_counted_;
}

// The other forms call these.
void* operator new(std::size_t size)
{
    return allocate_or_throw(size);
}
void* operator new(std::size_t size, std::align_val_t alignment)
{
    return allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept
{
    return allocate(size);
}
void* operator new[](std::size_t size)
{
    return allocate_or_throw(size);
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
