#pragma once

// Replaces operator new for the whole program, so that failing_memory.hpp works: one file of a
// test's program includes this. At its end the program says how many allocations failed.
// NOLINTBEGIN(misc-definitions-in-headers): it is a source that comes with the headers.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>

#include <busbar/harness/failing_memory.hpp>

namespace busbar::harness::detail {
namespace {

bool is_counting{false};
std::size_t count{0};
std::size_t first_failing{0};
std::size_t last_failing{0};
std::size_t live{0};
std::size_t failing_size{0};

/// The number of those that have failed.
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

/// Returns null if there is no memory. A sanitizer sees what lies past the size only without
/// aligned_alloc, whose sizes are multiples of the alignment.
void* take(std::size_t size, std::size_t alignment)
{
    if (alignment <= alignof(std::max_align_t)) {
        return std::malloc(size == 0 ? 1 : size);
    }
    if (size > SIZE_MAX - alignment) {
        return nullptr;
    }
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

/// Returns null if it is one of those that fail, or if there is no memory.
void* allocate(std::size_t size, std::size_t alignment = alignof(std::max_align_t)) noexcept
{
    const bool is_one_of_them = is_counting && ++count >= first_failing && count <= last_failing;
    if (is_one_of_them || (is_counting && failing_size != 0 && size >= failing_size)) {
        ++failures.count;
        return nullptr;
    }
    void* const memory = take(size, alignment);
    live += memory != nullptr ? 1 : 0;
    return memory;
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
} // namespace busbar::harness::detail

namespace busbar::harness {

void fail_allocation(std::size_t k, std::size_t most)
{
    detail::count = 0;
    detail::first_failing = k;
    detail::last_failing = k == 0 ? 0 : most > SIZE_MAX - (k - 1) ? SIZE_MAX : k + most - 1;
}

void fail_large_allocations(std::size_t size)
{
    detail::failing_size = size;
}

bool has_allocation_failed()
{
    return detail::first_failing != 0 && detail::count >= detail::first_failing;
}

std::size_t live_allocations()
{
    return detail::live;
}

Counted::Counted()
{
    detail::is_counting = true;
}

Counted::~Counted()
{
    detail::is_counting = false;
}

Uncounted::Uncounted() : was_counted_{detail::is_counting}
{
    detail::is_counting = false;
}

Uncounted::~Uncounted()
{
    detail::is_counting = was_counted_;
}

} // namespace busbar::harness

// All replaceable forms: none may take from, or give back to, another allocator than this one.
void* operator new(std::size_t size)
{
    return busbar::harness::detail::allocate_or_throw(size);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept
{
    return busbar::harness::detail::allocate(size);
}
void* operator new(std::size_t size, std::align_val_t alignment)
{
    return busbar::harness::detail::allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept
{
    return busbar::harness::detail::allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size)
{
    return busbar::harness::detail::allocate_or_throw(size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept
{
    return busbar::harness::detail::allocate(size);
}
void* operator new[](std::size_t size, std::align_val_t alignment)
{
    return busbar::harness::detail::allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept
{
    return busbar::harness::detail::allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept
{
    busbar::harness::detail::release(memory);
}
void operator delete(void* memory, std::size_t) noexcept
{
    busbar::harness::detail::release(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept
{
    busbar::harness::detail::release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept
{
    busbar::harness::detail::release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept
{
    busbar::harness::detail::release(memory);
}
void operator delete(void* memory, std::align_val_t, const std::nothrow_t&) noexcept
{
    busbar::harness::detail::release(memory);
}
void operator delete[](void* memory) noexcept
{
    busbar::harness::detail::release(memory);
}
void operator delete[](void* memory, std::size_t) noexcept
{
    busbar::harness::detail::release(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept
{
    busbar::harness::detail::release(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept
{
    busbar::harness::detail::release(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept
{
    busbar::harness::detail::release(memory);
}
void operator delete[](void* memory, std::align_val_t, const std::nothrow_t&) noexcept
{
    busbar::harness::detail::release(memory);
}
// NOLINTEND(misc-definitions-in-headers)
