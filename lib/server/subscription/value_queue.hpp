#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <busbar/core/data_value.hpp>

#include "core/fetch.hpp"

namespace busbar::server::detail {

/// What pays for the memory of items and messages.
class MemoryAccount {
public:
    /// `parent` pays as well; may be null.
    MemoryAccount(std::size_t limit, MemoryAccount* parent) : left_{limit}, parent_{parent} {}
    MemoryAccount(const MemoryAccount&) = delete;
    MemoryAccount& operator=(const MemoryAccount&) = delete;

    /// False, and nothing is charged, if there is not that much left.
    [[nodiscard]] bool charge(std::size_t bytes)
    {
        if (bytes == 0) { // as what is flat costs
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

/// True for what lies in a Variant, and in an array, without memory of its own.
[[nodiscard]] inline bool is_flat(BuiltInType type)
{
    return type < BuiltInType::String || type == BuiltInType::DateTime ||
           type == BuiltInType::Guid || type == BuiltInType::StatusCode;
}

/// held_bytes() of anything but a flat scalar.
[[nodiscard]] std::size_t held_bytes_apart(const Variant& value);

/// Bytes that a value holds besides the Variant itself; an estimate for what is nested.
[[nodiscard]] inline std::size_t held_bytes(const Variant& value)
{
    return is_flat(value.type()) && !value.is_array() ? 0 : held_bytes_apart(value);
}

/// The queue of a data item (Part 4, 5.13.1.5): a ring that never grows, whose newest value stays
/// behind when it was taken, as what the next sample is compared with.
///
/// An account pays for the ring and for what the values hold: the same in all calls.
class ValueQueue {
public:
    /// Bits of a value's status that this side sets (Part 4, 7.38.1): they do not count as a
    /// change.
    static constexpr std::uint32_t overflow_bits = 0x0480;
    static constexpr std::uint32_t structure_changed_bit = 0x8000;
    static constexpr std::uint32_t semantics_changed_bit = 0x4000;

    ValueQueue() = default;
    ValueQueue(const ValueQueue&) = delete;
    ValueQueue& operator=(const ValueQueue&) = delete;

    /// Gives back what the account has paid. To be called before the queue is destroyed.
    void release(MemoryAccount& account);

    /// Brings the queue to `capacity`, or to as much as the account can pay, which it returns.
    /// Queued values that have no place any more are discarded by the policy.
    std::uint32_t set_capacity(std::uint32_t capacity, bool discards_oldest,
                               MemoryAccount& account);
    [[nodiscard]] std::uint32_t capacity() const { return capacity_; }

    [[nodiscard]] std::size_t size() const { return size_; }
    /// The newest value, queued or taken; null if there was none since clear().
    [[nodiscard]] const DataValue* newest() const { return has_newest_ ? &at(newest_) : nullptr; }
    /// Queues a copy; `value` may stand for `data.value`. What the account cannot pay is queued as
    /// Bad_OutOfMemory; if it cannot be copied nothing changes, and std::bad_alloc is thrown. True
    /// if another one was lost to make place, but not in a queue of one.
    bool push(const DataValue& data, const Variant& value, StatusCode status,
              DateTime server_timestamp, MemoryAccount& account);
    /// Has the newest value and the place of the next brought near from memory.
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
    /// Where the next value goes.
    [[nodiscard]] std::uint32_t next_place() const;
    /// The newest value is there from now on; flags what is lost. True if it is the newest itself
    /// that has to tell of a loss.
    [[nodiscard]] bool take_place(std::uint32_t place);
    /// Leaves `most` of the values that wait.
    void discard(std::vector<DataValue>& values, std::size_t most, MemoryAccount& account) const;
    void move_to(std::unique_ptr<DataValue[]> ring, std::uint32_t capacity, MemoryAccount& account);

    /// Null with a capacity of 1, which most have.
    std::unique_ptr<DataValue[]> ring_;
    DataValue single_;
    std::uint32_t capacity_{1};
    std::uint32_t newest_{0};
    std::uint32_t size_{0};
    bool has_newest_{false};
    bool discards_oldest_{true};
};

} // namespace busbar::server::detail
