#pragma once

#include <array>
#include <chrono>
#include <cstddef>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>

namespace busbar::detail {

/// Large blocks that requests use in turn (see large_memory.hpp): as many bytes as it was told, and
/// none that nobody has needed for a while. Belongs to one thread.
class BUSBAR_API KeptMemory {
public:
    /// How long a block lies here at least; at most twice that.
    static constexpr Duration age = std::chrono::seconds{10};

    explicit KeptMemory(std::size_t max_bytes) : max_bytes_{max_bytes} {}
    KeptMemory(const KeptMemory&) = delete;
    KeptMemory& operator=(const KeptMemory&) = delete;
    ~KeptMemory();

    /// While it lives, this thread takes large memory from `kept` and gives it there.
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
    /// To be called at the end of each Use: from then on the time of its blocks runs.
    void note(TimePoint now)
    {
        if (held_ != 0 && deadline_ == no_deadline) {
            deadline_ = now + age;
        }
    }
    [[nodiscard]] TimePoint next_deadline() const { return deadline_; }
    /// Gives back what was not used since the last time.
    void handle_deadline(TimePoint now);

    // For allocate_large and free_large. The size of a block is what follows its header.

    struct Header;
    /// Null if there is none that has the size, or at most an eighth more: who holds it is charged
    /// for what he asked for.
    [[nodiscard]] Header* take(std::size_t bytes);
    /// False if it must be freed.
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
    /// Few are looked through faster than they are allocated.
    std::array<Block, 16> blocks_{};
    TimePoint deadline_{no_deadline};
};

} // namespace busbar::detail
