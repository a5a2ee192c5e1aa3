#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <busbar/core/data_value.hpp>

#include "core/fetch.hpp"

namespace busbar::server::detail {

/// An account for the memory of items and messages.
class MemoryAccount {
public:
    /// `parent` is charged as well; may be null.
    MemoryAccount(std::size_t limit, MemoryAccount* parent) : left_{limit}, parent_{parent} {}
    MemoryAccount(const MemoryAccount&) = delete;
    MemoryAccount& operator=(const MemoryAccount&) = delete;

    /// Returns false, with nothing charged, if there is not that much left.
    [[nodiscard]] bool charge(std::size_t bytes)
    {
        if (bytes == 0) { // the cost of a flat value
            return true;
        }
        if (bytes > left_ || (parent_ != nullptr && !parent_->charge(bytes))) {
            return false;
        }
        left_ -= bytes;
        return true;
    }
    void release(std::size_t bytes)
    {
        if (bytes == 0) {
            return;
        }
        left_ += bytes;
        if (parent_ != nullptr) {
            parent_->release(bytes);
        }
    }
    [[nodiscard]] std::size_t left() const
    {
        return parent_ != nullptr && parent_->left() < left_ ? parent_->left() : left_;
    }

private:
    std::size_t left_;
    MemoryAccount* parent_;
};

/// Returns true for types whose values need no memory outside a Variant or an array.
[[nodiscard]] inline bool is_flat(BuiltInType type)
{
    return type < BuiltInType::String || type == BuiltInType::DateTime ||
           type == BuiltInType::Guid || type == BuiltInType::StatusCode;
}

/// Returns held_bytes() of any value except a flat scalar.
[[nodiscard]] std::size_t held_bytes_apart(const Variant& value);

/// Returns the bytes of a value outside the Variant itself; an estimate for nested values.
[[nodiscard]] inline std::size_t held_bytes(const Variant& value)
{
    return is_flat(value.type()) && !value.is_array() ? 0 : held_bytes_apart(value);
}

/// The queue of a data item (Part 4, 5.13.1.5): a ring that never grows, whose newest value remains
/// after it was taken, to be compared with the next sample.
///
/// An account pays for the ring and for the memory of the values: the same one in all calls.
class ValueQueue {
public:
    /// Bits of a value's status that the server sets (Part 4, 7.38.1): they do not count as a
    /// change.
    static constexpr std::uint32_t overflow_bits = 0x0480;
    static constexpr std::uint32_t structure_changed_bit = 0x8000;
    static constexpr std::uint32_t semantics_changed_bit = 0x4000;

    ValueQueue() = default;
    ValueQueue(const ValueQueue&) = delete;
    ValueQueue& operator=(const ValueQueue&) = delete;

    /// Returns what the account has paid. Call it before the queue is destroyed.
    void release(MemoryAccount& account);

    /// Changes the capacity to `capacity`, or to as much as the account can pay, which it returns.
    /// Queued values beyond it are discarded by the policy.
    std::uint32_t set_capacity(std::uint32_t capacity, bool discards_oldest,
                               MemoryAccount& account);
    [[nodiscard]] std::uint32_t capacity() const { return capacity_; }

    [[nodiscard]] std::size_t size() const { return size_; }
    /// Returns the newest value, queued or taken; null if there was none since clear().
    [[nodiscard]] const DataValue* newest() const { return has_newest_ ? &at(newest_) : nullptr; }
    /// Queues a copy; `value` replaces `data.value`. A value that the account cannot pay for is
    /// queued as Bad_OutOfMemory; if it cannot be copied nothing changes, and std::bad_alloc is
    /// thrown. Returns true if another one was lost to make room, but not in a queue of one.
    bool push(const DataValue& data, const Variant& value, StatusCode status,
              DateTime server_timestamp, MemoryAccount& account);
    /// Prefetches the newest value and the place of the next one.
    void fetch() const
    {
        if (ring_ != nullptr) {
            busbar::detail::fetch_object(ring_[newest_]);
            busbar::detail::fetch_object(ring_[next_place()]);
        }
    }
    [[nodiscard]] const DataValue& oldest() const { return at(oldest_index()); }
    void pop() { --size_; }
    /// Queues the newest value again, if it was taken.
    void repeat() { size_ = size_ == 0 && has_newest_ ? 1 : size_; }
    void clear(MemoryAccount& account);

private:
    [[nodiscard]] const DataValue& at(std::uint32_t index) const
    {
        return ring_ != nullptr ? ring_[index] : single_;
    }
    [[nodiscard]] DataValue& at(std::uint32_t index)
    {
        return ring_ != nullptr ? ring_[index] : single_;
    }
    [[nodiscard]] std::uint32_t oldest_index() const
    {
        const std::uint32_t back = size_ - 1;
        return newest_ >= back ? newest_ - back : newest_ + capacity_ - back;
    }
    /// Returns the place of the next value.
    [[nodiscard]] std::uint32_t next_place() const;
    /// Makes `place` that of the newest value; flags a loss. Returns true if the newest one itself
    /// must report it.
    [[nodiscard]] bool take_place(std::uint32_t place);
    /// Keeps `most` of the waiting values.
    void discard(std::vector<DataValue>& values, std::size_t most, MemoryAccount& account) const;
    void move_to(std::unique_ptr<DataValue[]> ring, std::uint32_t capacity, MemoryAccount& account);

    /// Null for a capacity of 1, the usual one.
    std::unique_ptr<DataValue[]> ring_;
    DataValue single_;
    std::uint32_t capacity_{1};
    std::uint32_t newest_{0};
    std::uint32_t size_{0};
    bool has_newest_{false};
    bool discards_oldest_{true};
};

} // namespace busbar::server::detail
