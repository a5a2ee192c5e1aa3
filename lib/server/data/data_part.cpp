#include "data_part.hpp"

#include <algorithm>
#include <utility>

namespace busbar::server {

namespace detail {

bool Part::admit(const std::shared_ptr<SourceEntry>& source, std::size_t item_count)
{
    if (!source->charge(item_count)) {
        return false;
    }
    source_ = source;
    item_count_ = item_count;
    return true;
}

bool Part::settle(PartOwner& owner)
{
    owner_ = &owner;
    State expected = State::Running;
    return !state_.compare_exchange_strong(expected, State::Waiting);
}

void Part::abandon()
{
    owner_ = nullptr;
    State expected = State::Waiting;
    // If it fails the part is complete and in the queue, which will find no owner.
    static_cast<void>(state_.compare_exchange_strong(expected, State::Abandoned));
}

void Part::complete(StatusCode verdict)
{
    verdict_ = verdict;
    // `memory_` keeps this part alive until it is moved away, here or by the queue.
    const std::shared_ptr<SourceEntry> source = source_;
    source->release(item_count_);
    if (state_.exchange(State::Complete) == State::Waiting) {
        source->queue().push(*this);
    } else {
        const std::shared_ptr<void> memory = std::move(memory_);
    }
}

} // namespace detail

ReadBatch::ReadBatch(detail::ReadPart& part)
    : part_{&part}, items_{part.items}, slots_{part.results}, max_age_{part.max_age},
      is_sample_{part.is_sample}
{
}

ReadBatch::ReadBatch(ReadBatch&& other) noexcept
    : part_{std::exchange(other.part_, nullptr)}, items_{std::exchange(other.items_, {})},
      slots_{std::exchange(other.slots_, nullptr)}, max_age_{other.max_age_}, is_sample_{
                                                                                  other.is_sample_}
{
}

ReadBatch& ReadBatch::operator=(ReadBatch&& other) noexcept
{
    if (this != &other) {
        complete();
        part_ = std::exchange(other.part_, nullptr);
        items_ = std::exchange(other.items_, {});
        slots_ = std::exchange(other.slots_, nullptr);
        max_age_ = other.max_age_;
        is_sample_ = other.is_sample_;
    }
    return *this;
}

void ReadBatch::keep_alive(std::shared_ptr<const void> memory)
{
    if (part_ != nullptr) {
        part_->kept_alive = std::move(memory);
    }
}

void ReadBatch::complete()
{
    items_ = {};
    if (part_ != nullptr) {
        std::exchange(part_, nullptr)->complete();
    }
}

void ReadBatch::fail(StatusCode status)
{
    items_ = {};
    if (part_ != nullptr) {
        std::exchange(part_, nullptr)->complete(status);
    }
}

WriteBatch::WriteBatch(detail::WritePart& part)
    : part_{&part}, items_{part.items}, results_{part.results}
{
}

WriteBatch::WriteBatch(WriteBatch&& other) noexcept
    : part_{std::exchange(other.part_, nullptr)}, items_{std::exchange(other.items_, {})},
      results_{std::exchange(other.results_, nullptr)}
{
}

WriteBatch& WriteBatch::operator=(WriteBatch&& other) noexcept
{
    if (this != &other) {
        complete();
        part_ = std::exchange(other.part_, nullptr);
        items_ = std::exchange(other.items_, {});
        results_ = std::exchange(other.results_, nullptr);
    }
    return *this;
}

bool WriteBatch::is_abandoned() const
{
    return part_ != nullptr && part_->is_abandoned();
}

void WriteBatch::complete()
{
    items_ = {};
    if (part_ != nullptr) {
        std::exchange(part_, nullptr)->complete();
    }
}

void WriteBatch::finish(StatusCode status, std::string reason)
{
    if (status.is_bad() && part_ != nullptr) {
        part_->reason = std::move(reason);
        items_ = {};
        return std::exchange(part_, nullptr)->complete(status);
    }
    std::fill_n(results_, items_.size(), status);
    complete();
}

} // namespace busbar::server
