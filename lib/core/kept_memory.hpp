#pragma once

#include <array>
#include <chrono>
#include <cstddef>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>

namespace busbar::detail {

/// Large blocks that requests use in turn (see large_memory.hpp): up to a set number of bytes,
/// without blocks that have not been used for a while. Belongs to one thread.
class BUSBAR_API KeptMemory {
public:
    /// Minimum time that a block is kept; the maximum is twice that.
    static constexpr Duration age = std::chrono::seconds{10};

    explicit KeptMemory(std::size_t max_bytes) : max_bytes_{max_bytes} {}
    KeptMemory(const KeptMemory&) = delete;
    KeptMemory& operator=(const KeptMemory&) = delete;
    ~KeptMemory();

    /// While it lives, this thread takes large memory from `kept` and returns it there.
    class BUSBAR_API Use {
    public:
        explicit Use(KeptMemory& kept);
        Use(const Use&) = delete;
        Use& operator=(const Use&) = delete;
        ~Use();

    private:
        KeptMemory* before_;
    };

    [[nodiscard]] std::size_t held() const { return held_; }
    /// Call it at the end of each Use: from then on the age of its blocks counts.
    void note(TimePoint now)
    {
        if (held_ != 0 && deadline_ == no_deadline) {
            deadline_ = now + age;
        }
    }
    [[nodiscard]] TimePoint next_deadline() const { return deadline_; }
    /// Frees blocks that were not used since the last call.
    void handle_deadline(TimePoint now);

    // For allocate_large and free_large. The size of a block is that of the memory after its
    // header.

    struct Header;
    /// Returns a block of this size, or at most an eighth more, since its user is charged for the
    /// requested size; null if there is none.
    [[nodiscard]] Header* take(std::size_t bytes);
    /// Returns false if the caller must free it.
    [[nodiscard]] bool keep(Header* memory);

private:
    struct Block {
        Header* memory{nullptr};
        bool is_new{false};
    };

    template <typename Which>
    void free_blocks(Which which);

    std::size_t max_bytes_;
    std::size_t held_{0};
    /// So few blocks are searched faster than memory is allocated.
    std::array<Block, 16> blocks_{};
    TimePoint deadline_{no_deadline};
};

} // namespace busbar::detail
