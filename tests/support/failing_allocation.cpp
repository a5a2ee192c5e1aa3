#include "failing_allocation.hpp"

#include <cstdlib>
#include <new>

namespace {

bool is_counting{false};
std::size_t count{0};
std::size_t first_failing{0};
std::size_t last_failing{0};
std::size_t live{0};

/// Null if it is one of those that fail.
void* allocate(std::size_t size) noexcept
{
    if (is_counting && ++count >= first_failing && count <= last_failing) {
        return nullptr;
    }
    ++live;
    return std::malloc(size == 0 ? 1 : size);
}

void* allocate_or_throw(std::size_t size)
{
    void* const memory = allocate(size);
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

// The other forms call these. No type here asks for more than malloc aligns to.
void* operator new(std::size_t size)
{
    return allocate_or_throw(size);
}
void* operator new(std::size_t size, std::align_val_t)
{
    return allocate_or_throw(size);
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
