#include "kept_memory.hpp"

#include <algorithm>
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

struct alignas(std::max_align_t) KeptMemory::Header {
    std::size_t size;
};

namespace {

thread_local KeptMemory* in_use = nullptr;

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

template <typename Which>
void KeptMemory::free_blocks(Which which)
{
    for (Block& each : blocks_) {
        if (each.memory != nullptr && which(each)) {
            held_ -= each.memory->size;
            allow(each.memory + 1, each.memory->size);
            ::operator delete(std::exchange(each, Block{}).memory);
        }
    }
}

KeptMemory::~KeptMemory()
{
    free_blocks([](const Block&) { return true; });
}

KeptMemory::Use::Use(KeptMemory& kept) : before_{std::exchange(in_use, &kept)} {}

KeptMemory::Use::~Use()
{
    in_use = before_;
}

KeptMemory::Header* KeptMemory::take(std::size_t bytes)
{
    const auto size_of = [&](const Block& block) {
        const bool fits = block.memory != nullptr && block.memory->size >= bytes &&
                          block.memory->size - bytes <= bytes / 8;
        return fits ? block.memory->size : std::numeric_limits<std::size_t>::max();
    };
    auto* const best =
        std::min_element(blocks_.begin(), blocks_.end(),
                         [&](const Block& a, const Block& b) { return size_of(a) < size_of(b); });
    if (size_of(*best) == std::numeric_limits<std::size_t>::max()) {
        return nullptr;
    }
    Header* const memory = std::exchange(*best, Block{}).memory;
    held_ -= memory->size;
    allow(memory + 1, memory->size);
    return memory;
}

bool KeptMemory::keep(Header* memory)
{
    auto* const place = std::find_if(blocks_.begin(), blocks_.end(),
                                     [](const Block& each) { return each.memory == nullptr; });
    if (place == blocks_.end() || memory->size > max_bytes_ - held_) {
        return false;
    }
    held_ += memory->size;
    forbid(memory + 1, memory->size);
    *place = {memory, true};
    return true;
}

void KeptMemory::handle_deadline(TimePoint now)
{
    if (now < deadline_) {
        return;
    }
    free_blocks([](const Block& block) { return !block.is_new; });
    for (Block& each : blocks_) {
        each.is_new = false;
    }
    deadline_ = no_deadline;
    note(now);
}

void* allocate_large(std::size_t bytes)
{
    using Header = KeptMemory::Header;
    Header* memory = in_use != nullptr ? in_use->take(bytes) : nullptr;
    if (memory == nullptr) {
        memory = ::new (::operator new(sizeof(Header) + bytes)) Header{bytes};
    }
    return memory + 1;
}

void free_large(void* memory) noexcept
{
    auto* const header = static_cast<KeptMemory::Header*>(memory) - 1;
    if (in_use == nullptr || !in_use->keep(header)) {
        ::operator delete(header);
    }
}

} // namespace busbar::detail
