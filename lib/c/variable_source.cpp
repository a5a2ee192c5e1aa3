#include "variable_source.hpp"

#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::c {

namespace {

constexpr unsigned generation_shift = 32;
constexpr std::uint64_t place_mask = UINT32_MAX;

} // namespace

std::uint64_t VariableSource::add(Entry entry)
{
    std::size_t place = first_free_;
    if (place == 0) {
        entries_.push_back(std::move(entry));
        return entries_.size();
    }
    Entry& reused = entries_[place - 1];
    first_free_ = reused.next_free;
    entry.generation = reused.generation;
    reused = std::move(entry);
    return std::uint64_t{reused.generation} << generation_shift | place;
}

void VariableSource::remove(std::uint64_t handle) noexcept
{
    if (Entry* const entry = find(handle)) {
        const std::uint32_t generation = entry->generation + 1;
        *entry = Entry{};
        entry->generation = generation;
        entry->is_used = false;
        entry->next_free = first_free_;
        first_free_ = static_cast<std::size_t>(handle & place_mask);
    }
}

VariableSource::Entry* VariableSource::find(std::uint64_t handle)
{
    const std::uint64_t place = handle & place_mask;
    if (place == 0 || place > entries_.size()) {
        return nullptr;
    }
    Entry& entry = entries_[static_cast<std::size_t>(place - 1)];
    return entry.is_used && entry.generation == handle >> generation_shift ? &entry : nullptr;
}

VariableSource::Entry* VariableSource::kept(std::uint64_t handle)
{
    Entry* const entry = find(handle);
    return entry != nullptr && entry->read == nullptr && entry->write == nullptr ? entry : nullptr;
}

void VariableSource::keep(Entry& entry, DataValue value) const
{
    if (value.source_timestamp.is_null()) {
        value.source_timestamp = clock_->now();
    }
    entry.kept = std::move(value);
}

void VariableSource::read(server::ReadBatch batch)
{
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const Entry* const entry = find(batch.items()[i].handle);
        server::ReadSlot& slot = batch.results()[i];
        if (entry == nullptr) {
            slot.status = status::Bad_NodeIdUnknown; // removed
        } else if (entry->read != nullptr) {
            read_one(*entry, slot);
        } else {
            slot.shared = &entry->kept.value;
            slot.status = entry->kept.status;
            slot.source_timestamp = entry->kept.source_timestamp;
        }
    }
}

void VariableSource::read_one(const Entry& entry, server::ReadSlot& slot) const
{
    busbar_data_value made{};
    const StatusCode answer{entry.read(entry.context, entry.id_text.c_str(), &made)};
    slot.status = answer.is_bad() ? answer : StatusCode{made.status};
    if (slot.status.is_bad()) {
        return;
    }
    auto value = to_variant(made.value);
    if (!value) {
        slot.status = status::Bad_InternalError;
        return;
    }
    slot.value = *std::move(value);
    slot.source_timestamp = made.source_time != 0 ? DateTime{made.source_time} : clock_->now();
}

void VariableSource::write(server::WriteBatch batch)
{
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const server::WriteItem& item = batch.items()[i];
        Entry* const entry = find(item.handle);
        StatusCode& result = batch.results()[i];
        if (entry == nullptr) {
            result = status::Bad_NodeIdUnknown; // removed
            continue;
        }
        const StatusCode thrown =
            busbar::detail::caught([&] { result = write_one(*entry, *item.data); });
        if (thrown.is_bad()) {
            result = thrown;
        }
    }
}

StatusCode VariableSource::write_one(Entry& entry, const DataValue& value)
{
    if (entry.write != nullptr) {
        busbar_data_value in_c;
        scratch_.clear();
        static_cast<void>(to_c(value, scratch_, in_c)); // is in the status
        if (StatusCode{in_c.status}.is_bad()) {
            return status::Bad_NotSupported;
        }
        const StatusCode answer{entry.write(entry.context, entry.id_text.c_str(), &in_c)};
        if (answer.is_bad() || entry.read != nullptr) {
            return answer;
        }
    } else if (entry.read != nullptr) {
        return status::Bad_NotWritable;
    }
    keep(entry, DataValue{value});
    return status::Good;
}

} // namespace busbar::c
