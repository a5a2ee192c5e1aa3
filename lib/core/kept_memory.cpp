#include "kept_memory.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <new>
#include <utility>

#include <busbar/core/detail/large_memory.hpp>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/asan_interface.h>
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#include <sanitizer/asan_interface.h>
#endif
#endif

namespace busbar::detail {

namespace {

// Kept memory must not be accessed, which only a sanitizer can detect.

void forbid([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t size)
{
#if defined(ASAN_POISON_MEMORY_REGION)
    ASAN_POISON_MEMORY_REGION(memory, size);
#endif
}

void allow([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t size)
{
#if defined(ASAN_UNPOISON_MEMORY_REGION)
    ASAN_UNPOISON_MEMORY_REGION(memory, size);
#endif
}

} // namespace

class KeptMemory::Pool {
public:
    /// Precedes each block.
    struct alignas(std::max_align_t) Header {
        /// The size of the memory after it.
        std::size_t size;
        /// The keeper to which the memory returns; null for memory that is not kept.
        Pool* pool;
    };

    explicit Pool(std::size_t max_bytes) : max_bytes_{max_bytes} {}
    Pool(const Pool&) = delete;
    Pool& operator=(const Pool&) = delete;

    [[nodiscard]] std::size_t held() const { return held_.load(std::memory_order_relaxed); }

    /// Returns a block of this size, or at most an eighth more, since its user is charged for the
    /// requested size; null if there is none.
    [[nodiscard]] Header* take(std::size_t bytes)
    {
        const Turn turn{*this};
        if (!turn) {
            return nullptr;
        }
        const auto size_of = [&](const Block& block) {
            const bool fits = block.memory != nullptr && block.memory->size >= bytes &&
                              block.memory->size - bytes <= bytes / 8;
            return fits ? block.memory->size : std::numeric_limits<std::size_t>::max();
        };
        auto* const best =
            std::min_element(blocks_.begin(), blocks_.end(), [&](const Block& a, const Block& b) {
                return size_of(a) < size_of(b);
            });
        if (size_of(*best) == std::numeric_limits<std::size_t>::max()) {
            return nullptr;
        }
        add_user();
        return remove(*best);
    }
    /// Returns false if the caller must free it.
    [[nodiscard]] bool keep(Header* memory)
    {
        const Turn turn{*this};
        if (!turn || is_closed_ || memory->size > max_bytes_ - held()) {
            return false;
        }
        auto* const place = std::find_if(blocks_.begin(), blocks_.end(),
                                         [](const Block& each) { return each.memory == nullptr; });
        if (place == blocks_.end()) {
            return false;
        }
        held_.store(held() + memory->size, std::memory_order_relaxed);
        forbid(memory + 1, memory->size);
        *place = {memory, true};
        return true;
    }
    /// Frees the blocks that were there at the last call already.
    void age()
    {
        const Turn turn{*this};
        if (turn) {
            free_blocks([](const Block& block) { return !block.is_new; });
            for (Block& each : blocks_) {
                each.is_new = false;
            }
        }
    }
    /// Keeps nothing from now on. If another thread returns a block just now, what is kept goes
    /// with the last one.
    void close()
    {
        is_closed_ = true;
        {
            const Turn turn{*this};
            if (turn) {
                free_blocks([](const Block&) { return true; });
            }
        }
        remove_user();
    }

    void add_user() { users_.fetch_add(1, std::memory_order_relaxed); }
    void remove_user()
    {
        if (users_.fetch_sub(1, std::memory_order_acq_rel) == 1) {
            delete this;
        }
    }

private:
    struct Block {
        Header* memory{nullptr};
        bool is_new{false};
    };
    /// Access to the blocks; false while another thread has it. Waiting would let a task of low
    /// priority delay one of a high priority that frees a value.
    class Turn {
    public:
        explicit Turn(Pool& pool)
            : pool_{pool}, is_mine_{!pool.is_busy_.test_and_set(std::memory_order_acquire)}
        {
        }
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;
        ~Turn()
        {
            if (is_mine_) {
                pool_.is_busy_.clear(std::memory_order_release);
            }
        }
        explicit operator bool() const { return is_mine_; }

    private:
        Pool& pool_;
        bool is_mine_;
    };

    ~Pool()
    {
        free_blocks([](const Block&) { return true; });
    }
    Header* remove(Block& block)
    {
        Header* const memory = std::exchange(block, Block{}).memory;
        held_.store(held() - memory->size, std::memory_order_relaxed);
        allow(memory + 1, memory->size);
        return memory;
    }
    template <typename Which>
    void free_blocks(Which which)
    {
        for (Block& each : blocks_) {
            if (each.memory != nullptr && which(each)) {
                ::operator delete(remove(each));
            }
        }
    }

    std::size_t max_bytes_;
    std::atomic<std::size_t> held_{0};
    /// The KeptMemory and each block that is in use.
    std::atomic<std::size_t> users_{1};
    std::atomic_flag is_busy_ = ATOMIC_FLAG_INIT;
    std::atomic<bool> is_closed_{false};
    /// So few blocks are searched faster than memory is allocated.
    std::array<Block, 16> blocks_{};
};

KeptMemory::KeptMemory(std::size_t max_bytes) : pool_{new Pool{max_bytes}} {}

KeptMemory::~KeptMemory()
{
    pool_->close();
}

std::size_t KeptMemory::held() const
{
    return pool_->held();
}

void KeptMemory::handle_deadline(TimePoint now)
{
    if (now < deadline_) {
        return;
    }
    pool_->age();
    deadline_ = no_deadline;
    note(now);
}

void* allocate_large(std::size_t bytes, KeptMemory* memory)
{
    using Header = KeptMemory::Pool::Header;
    KeptMemory::Pool* const pool = memory != nullptr ? memory->pool_ : nullptr;
    Header* block = pool != nullptr ? pool->take(bytes) : nullptr;
    if (block == nullptr) {
        block = ::new (::operator new(sizeof(Header) + bytes)) Header{bytes, pool};
        if (pool != nullptr) {
            pool->add_user();
        }
    }
    return block + 1;
}

void free_large(void* memory) noexcept
{
    auto* const block = static_cast<KeptMemory::Pool::Header*>(memory) - 1;
    KeptMemory::Pool* const pool = block->pool;
    if (pool == nullptr || !pool->keep(block)) {
        ::operator delete(block);
    }
    if (pool != nullptr) {
        pool->remove_user();
    }
}

} // namespace busbar::detail
