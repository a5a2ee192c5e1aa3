#pragma once

#include <cstddef>
#include <new>

#include <busbar/core/api.hpp>

namespace busbar::detail {

/// From so many bytes on, memory comes from and goes to what the thread keeps, if it keeps any: a
/// process that gives pages back to its system takes a fault for each when it needs them again.
inline constexpr std::size_t large_memory = std::size_t{64} << 10U;

/// Memory for anything of fundamental alignment. Throws std::bad_alloc.
[[nodiscard]] BUSBAR_API void* allocate_large(std::size_t bytes);
/// What allocate_large gave, on any thread.
BUSBAR_API void free_large(void* memory) noexcept;

/// For containers that may become large.
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
