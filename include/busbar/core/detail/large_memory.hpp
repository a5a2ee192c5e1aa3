#pragma once

#include <cstddef>
#include <new>
#include <type_traits>

#include <busbar/core/api.hpp>

namespace busbar::detail {

/// Large blocks that a server or client keeps between requests.
class KeptMemory;

/// Blocks of this many bytes or more can come from a KeptMemory, and return there: a process that
/// returns pages to its system takes a fault for each when it needs them again.
inline constexpr std::size_t large_memory = std::size_t{64} << 10U;

/// Allocates memory for anything of fundamental alignment, of `memory` if that is not null. Throws
/// std::bad_alloc.
[[nodiscard]] BUSBAR_API void* allocate_large(std::size_t bytes, KeptMemory* memory);
/// Frees memory of allocate_large, or returns it where it came from, on any thread.
BUSBAR_API void free_large(void* memory) noexcept;

/// An allocator for containers that may become large. A KeptMemory lives as long as they allocate.
template <typename T>
struct LargeAllocator {
    using value_type = T;
    // Every block knows where it returns, so that containers can exchange theirs.
    using propagate_on_container_copy_assignment = std::false_type;
    using propagate_on_container_move_assignment = std::true_type;
    using propagate_on_container_swap = std::true_type;
    using is_always_equal = std::true_type;

    LargeAllocator() = default;
    explicit LargeAllocator(KeptMemory* memory) : memory_{memory} {}
    template <typename Other>
    LargeAllocator(const LargeAllocator<Other>& other) : memory_{other.memory()}
    {
    }

    [[nodiscard]] KeptMemory* memory() const { return memory_; }

    [[nodiscard]] T* allocate(std::size_t count)
    {
        if (is_large(count)) {
            return static_cast<T*>(allocate_large(count * sizeof(T), memory_));
        }
        return static_cast<T*>(::operator new (count * sizeof(T), std::align_val_t{alignof(T)}));
    }
    void deallocate(T* memory, std::size_t count) noexcept
    {
        if (is_large(count)) {
            free_large(memory);
        } else {
            ::operator delete (memory, std::align_val_t{alignof(T)});
        }
    }

    friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }

private:
    [[nodiscard]] static constexpr bool is_large(std::size_t count)
    {
        return alignof(T) <= alignof(std::max_align_t) && count >= large_memory / sizeof(T);
    }

    KeptMemory* memory_{nullptr};
};

} // namespace busbar::detail
