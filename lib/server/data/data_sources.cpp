#include "data_sources.hpp"

#include <utility>

#include <busbar/model/new_node.hpp>

#include "data_part.hpp"

namespace busbar::server {

void DataSource::detach()
{
    if (self_ != nullptr) {
        *self_ = nullptr;
    }
}

model::BoundValue DataSource::variable(std::uint64_t handle, const Variant& like) const
{
    return {index_ == model::no_source ? Variant{} : like, index_, handle};
}

namespace detail {

void CompletionQueue::push(Part& part)
{
    const bool was_empty = completed_.push(part);
    if (closed_) {
        drop(completed_.take());
    } else if (was_empty) {
        waker_.wake();
    }
}

void CompletionQueue::drain()
{
    struct Rest {
        ~Rest()
        {
            if (queue.told_next_ != nullptr) {
                queue.waker_.wake();
            }
        }
        CompletionQueue& queue;
    };
    const Rest rest{*this};
    Part** end = &told_next_;
    while (*end != nullptr) {
        end = &(*end)->next;
    }
    *end = completed_.take();
    while (told_next_ != nullptr) {
        Part* const part = std::exchange(told_next_, told_next_->next);
        const std::shared_ptr<void> memory = std::move(part->memory_);
        if (part->owner_ != nullptr) {
            part->owner_->part_completed(*part);
        }
    }
}

void CompletionQueue::drop(Part* first)
{
    while (first != nullptr) {
        Part* const next = first->next;
        const std::shared_ptr<void> memory = std::move(first->memory_);
        first = next;
    }
}

void CompletionQueue::close()
{
    closed_ = true;
    drop(std::exchange(told_next_, nullptr));
    drop(completed_.take());
    waker_.set(nullptr);
}

SourceEntry::SourceEntry(DataSource& source, std::shared_ptr<CompletionQueue> queue, LogSink& log)
    : options_{source.options()}, queue_{std::move(queue)}, log_{&log}
{
    if (source.self_ == nullptr) {
        source.self_ = std::make_shared<DataSource*>(&source);
    }
    source_ = source.self_;
}

ProcessImage* SourceEntry::process_image() const
{
    ProcessImage* image = nullptr;
    guard("DataSource::process_image", [&](DataSource& source) { image = source.process_image(); });
    return image;
}

bool SourceEntry::charge(std::size_t item_count)
{
    // Only the server's thread adds, so that checking before adding is enough.
    if (batches_ >= options_.max_batches || item_count > options_.max_items - items_) {
        return false;
    }
    ++batches_;
    items_ += item_count;
    return true;
}

Result<std::size_t> SourceEntry::charge_monitored(std::uint64_t handle)
{
    Result<std::size_t> size{0};
    // A missing or throwing source is reported when the item is sampled.
    guard("DataSource::monitored_size",
          [&](const DataSource& source) { size = source.monitored_size(handle); });
    if (!size) {
        return size;
    }
    if (*size > options_.max_monitored_size - monitored_size_) {
        return fail(status::Bad_TooManyMonitoredItems);
    }
    monitored_size_ += *size;
    return size;
}

void SourceEntry::release(std::size_t item_count)
{
    items_ -= item_count;
    --batches_;
}

DataSources::~DataSources()
{
    for (const auto& entry : entries_) {
        entry->guard("DataSource::attach", [](DataSource& source) { source.attach(nullptr); });
    }
    queue_->close();
}

void DataSources::suspend(StatusCode status)
{
    suspension_ = status;
    for (const auto& entry : entries_) {
        entry->suspend(status);
    }
}

void DataSources::handle_completions()
{
    for (const auto& entry : entries_) {
        entry->guard("DataSource::handle_completions",
                     [](DataSource& source) { source.handle_completions(); });
    }
    queue_->drain();
}

std::uint32_t DataSources::add(DataSource& source)
{
    source.index_ = static_cast<std::uint32_t>(entries_.size());
    entries_.push_back(std::make_shared<SourceEntry>(source, queue_, *log_));
    entries_.back()->suspend(suspension_);
    entries_.back()->guard("DataSource::attach", [this](DataSource& one) { one.attach(waker_); });
    return source.index_;
}

std::uint32_t DataSources::add(std::shared_ptr<DataSource> source)
{
    kept_.push_back(std::move(source));
    return add(*kept_.back());
}

} // namespace detail

} // namespace busbar::server
