// The operator new of programs that link this layer as a static library and have none of their own.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>

#include <openssl/crypto.h>

#include <busbar/busbar.h>

#ifdef BUSBAR_C_HAS_PUGIXML
#include <pugixml.hpp>
#endif

namespace busbar::c {

namespace {

/// Stands before each block: its size, and the beginning of its memory.
struct BlockHead {
    std::size_t size;
    void* memory;
};

/// The state of the process: operator new has no object to be a member of.
struct ProcessMemory {
    busbar_allocator allocator{};
    std::atomic<std::uint64_t> blocks{0};
    std::atomic<std::uint64_t> bytes{0};
    std::atomic<std::uint64_t> largest{0};
    std::atomic<std::uint64_t> allocations{0};
    std::atomic<std::uint64_t> failed{0};
};
constinit ProcessMemory process_memory;

constexpr std::size_t plain_alignment = alignof(std::max_align_t);

void* take_memory(std::size_t size, std::size_t alignment) noexcept
{
    const busbar_allocator& from = process_memory.allocator;
    if (from.allocate != nullptr) {
        return from.allocate(from.context, size, alignment);
    }
    return alignment <= plain_alignment
               ? std::malloc(size)
               : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void give_memory(void* memory) noexcept
{
    const busbar_allocator& from = process_memory.allocator;
    if (from.allocate != nullptr) {
        from.release(from.context, memory);
    } else {
        std::free(memory);
    }
}

void count_block(std::size_t size) noexcept
{
    constexpr auto relaxed = std::memory_order_relaxed;
    process_memory.blocks.fetch_add(1, relaxed);
    process_memory.allocations.fetch_add(1, relaxed);
    const std::uint64_t now = process_memory.bytes.fetch_add(size, relaxed) + size;
    std::uint64_t largest = process_memory.largest.load(relaxed);
    while (largest < now && !process_memory.largest.compare_exchange_weak(largest, now, relaxed)) {
    }
}

/// Returns null if there is no memory.
void* allocate_block(std::size_t size, std::size_t alignment = plain_alignment) noexcept
{
    alignment = std::max(alignment, plain_alignment);
    const std::size_t before = std::max(alignment, sizeof(BlockHead));
    void* const memory = size <= std::numeric_limits<std::ptrdiff_t>::max() - 2 * before
                             ? take_memory(size + before, alignment)
                             : nullptr;
    if (memory == nullptr) {
        process_memory.failed.fetch_add(1, std::memory_order_relaxed);
        return nullptr;
    }
    std::byte* const block = static_cast<std::byte*>(memory) + before;
    ::new (static_cast<void*>(block - sizeof(BlockHead))) BlockHead{size, memory};
    count_block(size);
    return block;
}

void release_block(void* block) noexcept
{
    if (block == nullptr) {
        return;
    }
    const auto* head = std::launder(static_cast<BlockHead*>(
        static_cast<void*>(static_cast<std::byte*>(block) - sizeof(BlockHead))));
    process_memory.blocks.fetch_sub(1, std::memory_order_relaxed);
    process_memory.bytes.fetch_sub(head->size, std::memory_order_relaxed);
    give_memory(head->memory);
}

// OpenSSL's functions, which get a place in its sources as well.

void* allocate_for_openssl(std::size_t size, const char* /*file*/, int /*line*/)
{
    return size == 0 ? nullptr : allocate_block(size);
}

void release_for_openssl(void* block, const char* /*file*/, int /*line*/)
{
    release_block(block);
}

void* reallocate_for_openssl(void* block, std::size_t size, const char* /*file*/, int /*line*/)
{
    if (size == 0) {
        release_block(block);
        return nullptr;
    }
    void* const larger = allocate_block(size);
    if (larger != nullptr && block != nullptr) {
        const auto* head = std::launder(static_cast<BlockHead*>(
            static_cast<void*>(static_cast<std::byte*>(block) - sizeof(BlockHead))));
        std::copy_n(static_cast<const std::byte*>(block), std::min(size, head->size),
                    static_cast<std::byte*>(larger));
        release_block(block);
    }
    return larger;
}

/// True if operator new for this alignment is the one below; then it counts, also if it finds no
/// memory.
bool is_counted(std::size_t alignment)
{
    const auto count = [] {
        return process_memory.allocations.load() + process_memory.failed.load();
    };
    const std::uint64_t before = count();
    const std::align_val_t aligned{alignment};
    if (alignment <= plain_alignment) {
        void* volatile probe = ::operator new(1, std::nothrow);
        ::operator delete(probe);
    } else {
        void* volatile probe = ::operator new(1, aligned, std::nothrow);
        ::operator delete(probe, aligned);
    }
    return count() != before;
}

/// True if operator new, plain and aligned, is the one below and not the program's.
bool is_operator_new_ours()
{
    return is_counted(plain_alignment) && is_counted(2 * plain_alignment);
}

} // namespace

} // namespace busbar::c

using namespace busbar::c;

busbar_status busbar_set_allocator(const busbar_allocator* allocator)
{
    if (allocator == nullptr || allocator->size != sizeof *allocator ||
        allocator->allocate == nullptr || allocator->release == nullptr) {
        return BUSBAR_BAD_INVALID_ARGUMENT;
    }
    if (!is_operator_new_ours()) {
        return BUSBAR_BAD_NOT_SUPPORTED;
    }
    // OpenSSL accepts others only before its first allocation.
    if (process_memory.blocks.load() != 0 || process_memory.allocator.allocate != nullptr ||
        CRYPTO_set_mem_functions(allocate_for_openssl, reallocate_for_openssl,
                                 release_for_openssl) == 0) {
        return BUSBAR_BAD_INVALID_STATE;
    }
#ifdef BUSBAR_C_HAS_PUGIXML
    pugi::set_memory_management_functions([](std::size_t size) { return allocate_block(size); },
                                          [](void* block) { release_block(block); });
#endif
    process_memory.allocator = *allocator;
    return BUSBAR_GOOD;
}

busbar_status busbar_memory_in_use(busbar_memory* memory)
{
    if (memory == nullptr || memory->size != sizeof *memory) {
        return BUSBAR_BAD_INVALID_ARGUMENT;
    }
    if (!is_operator_new_ours()) {
        return BUSBAR_BAD_NOT_SUPPORTED;
    }
    memory->blocks = process_memory.blocks.load();
    memory->bytes = process_memory.bytes.load();
    memory->largest_bytes = process_memory.largest.load();
    memory->allocations = process_memory.allocations.load();
    memory->failed = process_memory.failed.load();
    return BUSBAR_GOOD;
}

#ifdef BUSBAR_C_HAS_OPERATOR_NEW
namespace {

void* allocate_or_throw(std::size_t size, std::size_t alignment = plain_alignment)
{
    void* const block = allocate_block(size, alignment);
    if (block == nullptr) {
        throw std::bad_alloc{};
    }
    return block;
}

/// Calls an operator new that throws; null if it does.
template <typename New>
void* null_for_throw(New throwing) noexcept
{
    try {
        return throwing();
    } catch (...) {
        return nullptr;
    }
}

} // namespace

// All replaceable forms, weak: a program's own ones take their places. Four of them do the work;
// the others forward to these as the C++ library's do, so that a program may replace only some.
#define BUSBAR_REPLACEABLE __attribute__((weak))
BUSBAR_REPLACEABLE void* operator new(std::size_t size)
{
    return allocate_or_throw(size);
}
BUSBAR_REPLACEABLE void* operator new(std::size_t size, std::align_val_t alignment)
{
    return allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
BUSBAR_REPLACEABLE void operator delete(void* block) noexcept
{
    release_block(block);
}
BUSBAR_REPLACEABLE void operator delete(void* block, std::align_val_t) noexcept
{
    release_block(block);
}

BUSBAR_REPLACEABLE void* operator new(std::size_t size, const std::nothrow_t&) noexcept
{
    return null_for_throw([&] { return ::operator new(size); });
}
BUSBAR_REPLACEABLE void* operator new(std::size_t size, std::align_val_t alignment,
                                      const std::nothrow_t&) noexcept
{
    return null_for_throw([&] { return ::operator new(size, alignment); });
}
BUSBAR_REPLACEABLE void* operator new[](std::size_t size)
{
    return ::operator new(size);
}
BUSBAR_REPLACEABLE void* operator new[](std::size_t size, const std::nothrow_t&) noexcept
{
    return null_for_throw([&] { return ::operator new[](size); });
}
BUSBAR_REPLACEABLE void* operator new[](std::size_t size, std::align_val_t alignment)
{
    return ::operator new(size, alignment);
}
BUSBAR_REPLACEABLE void* operator new[](std::size_t size, std::align_val_t alignment,
                                        const std::nothrow_t&) noexcept
{
    return null_for_throw([&] { return ::operator new[](size, alignment); });
}
BUSBAR_REPLACEABLE void operator delete(void* block, std::size_t) noexcept
{
    ::operator delete(block);
}
BUSBAR_REPLACEABLE void operator delete(void* block, const std::nothrow_t&) noexcept
{
    ::operator delete(block);
}
BUSBAR_REPLACEABLE void operator delete(void* block, std::size_t,
                                        std::align_val_t alignment) noexcept
{
    ::operator delete(block, alignment);
}
BUSBAR_REPLACEABLE void operator delete(void* block, std::align_val_t alignment,
                                        const std::nothrow_t&) noexcept
{
    ::operator delete(block, alignment);
}
BUSBAR_REPLACEABLE void operator delete[](void* block) noexcept
{
    ::operator delete(block);
}
BUSBAR_REPLACEABLE void operator delete[](void* block, std::size_t) noexcept
{
    ::operator delete[](block);
}
BUSBAR_REPLACEABLE void operator delete[](void* block, const std::nothrow_t&) noexcept
{
    ::operator delete[](block);
}
BUSBAR_REPLACEABLE void operator delete[](void* block, std::align_val_t alignment) noexcept
{
    ::operator delete(block, alignment);
}
BUSBAR_REPLACEABLE void operator delete[](void* block, std::size_t,
                                          std::align_val_t alignment) noexcept
{
    ::operator delete[](block, alignment);
}
BUSBAR_REPLACEABLE void operator delete[](void* block, std::align_val_t alignment,
                                          const std::nothrow_t&) noexcept
{
    ::operator delete[](block, alignment);
}
#endif
