#pragma once

#include <cstddef>
#include <new>

#include <busbar/core/api.hpp>

namespace busbar::detail {

/// Blocks of this many bytes or more come from and go to the memory that the thread keeps, if it
/// keeps any: a process that returns pages to its system takes a fault for each when it needs them
/// again.
inline constexpr std::size_t large_memory = std::size_t{64} << 10U;

/// Allocates memory for anything of fundamental alignment. Throws std::bad_alloc.
[[nodiscard]] BUSBAR_API void* allocate_large(std::size_t bytes);
/// Frees memory of allocate_large, on any thread.
BUSBAR_API void free_large(void* memory) noexcept;

/// An allocator for containers that may become large.
template <typename T>
struct LargeAllocator {
    using value_type = T;

    LargeAllocator() = default;
    template <typename Other>
    LargeAllocator(const LargeAllocator<Other>&)
    {
    }

    [[nodiscard]] T* allocate(std::size_t count)
    {
        if (is_large(count)) {
            return static_cast<T*>(allocate_large(count * sizeof(T)));
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
};

} // namespace busbar::detail
