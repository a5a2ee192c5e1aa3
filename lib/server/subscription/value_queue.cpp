#include "value_queue.hpp"

#include <algorithm>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/core/detail/guarded.hpp>

namespace busbar::server::detail {

namespace {

StatusCode with_bits(StatusCode status, std::uint32_t bits)
{
    return StatusCode{status.value() | bits};
}

} // namespace

std::size_t held_bytes_apart(const Variant& value)
{
    if (is_flat(value.type())) {
        return value.array_size() * 16 + 32;
    }
    if (const String* text = value.get_if<String>()) {
        return text->size();
    }
    if (const ByteString* bytes = value.get_if<ByteString>()) {
        return bytes->size();
    }
    // Objects are larger than their encoding by at most their fields' headers.
    return 64 + 8 * binary::encoded_size(value);
}

void ValueQueue::release(MemoryAccount& account)
{
    clear(account);
    account.release(ring_ != nullptr ? capacity_ * sizeof(DataValue) : 0);
}

std::uint32_t ValueQueue::set_capacity(std::uint32_t capacity, bool discards_oldest,
                                       MemoryAccount& account)
{
    discards_oldest_ = discards_oldest;
    capacity = std::max(capacity, 1U);
    if (capacity == capacity_) {
        return capacity_;
    }
    const std::size_t old_cost = ring_ != nullptr ? capacity_ * sizeof(DataValue) : 0;
    account.release(old_cost);
    busbar::detail::Undo undo{[&] { static_cast<void>(account.charge(old_cost)); }};
    const std::size_t most = account.left() / sizeof(DataValue);
    capacity = std::max(static_cast<std::uint32_t>(std::min<std::size_t>(capacity, most)), 1U);
    std::unique_ptr<DataValue[]> ring;
    if (capacity > 1) {
        ring = std::make_unique<DataValue[]>(capacity);
    }
    move_to(std::move(ring), capacity, account);
    undo.keep();
    if (capacity > 1) {
        static_cast<void>(account.charge(capacity * sizeof(DataValue))); // that much is available
    }
    return capacity_;
}

void ValueQueue::discard(std::vector<DataValue>& values, std::size_t most,
                         MemoryAccount& account) const
{
    if (values.size() <= most) {
        return;
    }
    // The oldest are dropped, or those before the newest; a queue of one keeps the newest in any
    // case.
    const bool loses_oldest = discards_oldest_ || most == 1;
    const auto lost = static_cast<std::ptrdiff_t>(values.size() - most);
    const auto first = loses_oldest ? values.begin() : values.end() - 1 - lost;
    for (auto at = first; at != first + lost; ++at) {
        account.release(held_bytes(at->value));
    }
    values.erase(first, first + lost);
    DataValue& flagged = loses_oldest ? values.front() : values.back();
    flagged.status = with_bits(flagged.status, most > 1 ? overflow_bits : 0);
}

void ValueQueue::move_to(std::unique_ptr<DataValue[]> ring, std::uint32_t capacity,
                         MemoryAccount& account)
{
    const bool is_taken = size_ == 0;
    std::vector<DataValue> values;
    values.reserve(std::max(size_, 1U)); // and from here on nothing must fail
    size_ = std::max(size_, has_newest_ ? 1U : 0U);
    for (std::uint32_t i = 0; i < size_; ++i) {
        values.push_back(std::move(at((oldest_index() + i) % capacity_)));
    }
    for (std::uint32_t i = 0; i < capacity_; ++i) { // taken values that are not overwritten yet
        account.release(held_bytes(at(i).value));
        at(i).value = Variant{};
    }
    discard(values, capacity, account);
    ring_ = std::move(ring);
    capacity_ = capacity;
    for (std::uint32_t i = 0; i < values.size(); ++i) {
        at(i) = std::move(values[i]);
    }
    newest_ = values.empty() ? 0 : static_cast<std::uint32_t>(values.size() - 1);
    size_ = is_taken ? 0 : static_cast<std::uint32_t>(values.size());
}

std::uint32_t ValueQueue::next_place() const
{
    if (size_ == capacity_ && capacity_ > 1 && !discards_oldest_) {
        return newest_;
    }
    return newest_ + 1 == capacity_ ? 0 : newest_ + 1;
}

bool ValueQueue::take_place(std::uint32_t place)
{
    const bool is_overflow = size_ == capacity_ && capacity_ > 1;
    if (is_overflow && discards_oldest_) { // this was the oldest; the next one reports the loss
        DataValue& next = at(place + 1 == capacity_ ? 0 : place + 1);
        next.status = with_bits(next.status, overflow_bits);
        --size_;
    }
    newest_ = place;
    has_newest_ = true;
    const bool tells_of_loss = is_overflow && !discards_oldest_;
    size_ += size_ < capacity_ && !tells_of_loss ? 1 : 0;
    return tells_of_loss;
}

bool ValueQueue::push(const DataValue& data, const Variant& value, StatusCode status,
                      DateTime server_timestamp, MemoryAccount& account)
{
    const bool has_lost = size_ == capacity_ && capacity_ > 1;
    const std::uint32_t place = next_place();
    DataValue& to = at(place);
    const std::size_t size = held_bytes(value);
    const std::size_t held = held_bytes(to.value);
    bool is_paid = true;
    if (size == 0 &&
        held == 0) { // most are flat: there is nothing to pay for, and nothing can fail
        to.value = value;
    } else {
        is_paid = size <= account.left() + held;
        Variant copy = is_paid ? value : Variant{}; // before anything changes, as it may fail
        account.release(held);
        is_paid = is_paid && account.charge(size);
        to.value = is_paid ? std::move(copy) : Variant{};
    }
    const bool tells_of_loss = take_place(place);
    to.status =
        is_paid ? with_bits(status, tells_of_loss ? overflow_bits : 0) : status::Bad_OutOfMemory;
    to.source_timestamp = data.source_timestamp;
    to.source_picoseconds = data.source_picoseconds;
    to.server_timestamp = server_timestamp;
    return has_lost;
}

void ValueQueue::clear(MemoryAccount& account)
{
    for (std::uint32_t i = 0; i < capacity_; ++i) {
        account.release(held_bytes(at(i).value));
        at(i).value = Variant{};
    }
    size_ = 0;
    has_newest_ = false;
}

} // namespace busbar::server::detail
