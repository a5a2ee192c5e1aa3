#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/fetch.hpp"

namespace busbar::model::detail {

/// A multimap from hashes to record numbers: open addressing with 4 bytes a slot, 24 bits for the
/// record and 8 for a tag of the hash, so that a record is read only if it likely matches.
/// `hash_of` returns the hash of a record in the table.
class IndexTable {
public:
    static constexpr std::uint32_t none = UINT32_MAX;
    /// Upper bound of record numbers.
    static constexpr std::uint32_t max_records = (1U << 24U) - 1;

    /// Returns the first record with this hash for which `match` returns true.
    template <typename Match>
    [[nodiscard]] std::uint32_t find(std::uint64_t hash, Match match) const
    {
        if (slots_.empty()) {
            return none;
        }
        const std::uint32_t tag = tag_of(hash);
        for (std::size_t at = home(hash);; at = (at + 1) & mask()) {
            const std::uint32_t slot = slots_[at];
            if (slot == 0) {
                return none;
            }
            if ((slot & tag_mask) == tag && match((slot & ~tag_mask) - 1)) {
                return (slot & ~tag_mask) - 1;
            }
        }
    }
    /// Prefetches the slot at which the search for this hash begins.
    void fetch_slot(std::uint64_t hash) const
    {
        if (!slots_.empty()) {
            busbar::detail::fetch(&slots_[home(hash)]);
        }
    }
    /// Returns the first record that find() would read.
    [[nodiscard]] std::uint32_t likely(std::uint64_t hash) const
    {
        return find(hash, [](std::uint32_t) { return true; });
    }
    template <typename HashOf>
    void insert(std::uint64_t hash, std::uint32_t record, HashOf hash_of)
    {
        make_room(hash_of);
        ++size_;
        place(hash, record);
    }
    /// Removes everything. To insert as much again needs no memory.
    void clear()
    {
        std::fill(slots_.begin(), slots_.end(), 0U);
        size_ = 0;
    }
    /// Makes sure that the next insert() needs no memory.
    template <typename HashOf>
    void make_room(HashOf hash_of)
    {
        if ((size_ + 1) * 4 > slots_.size() * 3) {
            resize(slots_.empty() ? 64 : slots_.size() * 2, hash_of);
        }
    }
    /// Removes a record from the table.
    template <typename HashOf>
    void erase(std::uint64_t hash, std::uint32_t record, HashOf hash_of)
    {
        std::size_t hole = home(hash);
        while ((slots_[hole] & ~tag_mask) != record + 1) {
            hole = (hole + 1) & mask();
        }
        --size_;
        // Moves records up that a search would not find past the hole.
        for (std::size_t at = (hole + 1) & mask(); slots_[at] != 0; at = (at + 1) & mask()) {
            const std::size_t first = home(hash_of((slots_[at] & ~tag_mask) - 1));
            if (((at - first) & mask()) >= ((at - hole) & mask())) {
                slots_[hole] = slots_[at];
                hole = at;
            }
        }
        slots_[hole] = 0;
    }
    template <typename HashOf>
    void reserve(std::size_t records, HashOf hash_of)
    {
        std::size_t size = 64;
        while (records * 4 > size * 3) {
            size *= 2;
        }
        if (size > slots_.size()) {
            resize(size, hash_of);
        }
    }

private:
    static constexpr std::uint32_t tag_mask = 0xFF000000U;

    [[nodiscard]] static std::uint32_t tag_of(std::uint64_t hash)
    {
        return static_cast<std::uint32_t>(hash >> 32U) & tag_mask;
    }
    [[nodiscard]] std::size_t mask() const { return slots_.size() - 1; }
    /// Returns the slot where the search for a hash begins.
    [[nodiscard]] std::size_t home(std::uint64_t hash) const
    {
        return static_cast<std::size_t>(hash) & mask();
    }
    void place(std::uint64_t hash, std::uint32_t record)
    {
        std::size_t at = home(hash);
        while (slots_[at] != 0) {
            at = (at + 1) & mask();
        }
        slots_[at] = tag_of(hash) | (record + 1);
    }
    template <typename HashOf>
    void resize(std::size_t size, HashOf hash_of)
    {
        std::vector<std::uint32_t> old(size);
        old.swap(slots_);
        for (const std::uint32_t slot : old) {
            if (slot != 0) {
                const std::uint32_t record = (slot & ~tag_mask) - 1;
                place(hash_of(record), record);
            }
        }
    }

    std::vector<std::uint32_t> slots_;
    std::size_t size_{0};
};

} // namespace busbar::model::detail
