#include "variable_source.hpp"

#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::c {

std::uint64_t VariableSource::add(Entry entry)
{
    entries_.push_back(std::move(entry));
    return entries_.size();
}

VariableSource::Entry* VariableSource::kept(std::uint64_t handle)
{
    if (handle == 0 || handle > entries_.size()) {
        return nullptr;
    }
    Entry& entry = entries_[static_cast<std::size_t>(handle - 1)];
    return entry.read == nullptr && entry.write == nullptr ? &entry : nullptr;
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
        const Entry& entry = entries_[static_cast<std::size_t>(batch.items()[i].handle - 1)];
        server::ReadSlot& slot = batch.results()[i];
        if (entry.read != nullptr) {
            read_one(entry, slot);
        } else {
            slot.shared = &entry.kept.value;
            slot.status = entry.kept.status;
            slot.source_timestamp = entry.kept.source_timestamp;
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
        Entry& entry = entries_[static_cast<std::size_t>(item.handle - 1)];
        StatusCode& result = batch.results()[i];
        const StatusCode thrown =
            busbar::detail::caught([&] { result = write_one(entry, *item.data); });
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
        to_c(value, scratch_, in_c);
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
