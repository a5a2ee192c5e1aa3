#include "image_watch.hpp"

#include <array>
#include <cstring>
#include <span>
#include <string>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "core/fetch.hpp"
#include "server/data/read_results.hpp"

namespace busbar::server::detail {

namespace {

template <std::size_t size>
bool take_new(std::byte* seen, const std::byte* now)
{
    const bool is_new = std::memcmp(seen, now, size) != 0;
    std::memcpy(seen, now, size);
    return is_new;
}

/// Copies `now` to `seen`; true if they differed.
bool take_new(std::byte* seen, const std::byte* now, std::size_t size)
{
    switch (size) { // known sizes need no function call
    case 1:
        return take_new<1>(seen, now);
    case 2:
        return take_new<2>(seen, now);
    case 4:
        return take_new<4>(seen, now);
    case 8:
        return take_new<8>(seen, now);
    default:
        break;
    }
    const bool is_new = std::memcmp(seen, now, size) != 0;
    if (is_new) {
        std::memcpy(seen, now, size);
    }
    return is_new;
}

} // namespace

std::uint32_t ImageWatch::variable_of(std::uint32_t handle)
{
    const auto found = known_.find(handle);
    return found != known_.end() ? found->second : add_variable(handle);
}

std::uint32_t ImageWatch::add_variable(std::uint32_t handle)
{
    const std::uint32_t size = image_->place(handle).bytes();
    const std::size_t cost = size + sizeof(Variable) + 8 * sizeof(void*);
    const bool is_kept = account_->charge(cost);
    const Variable added{handle, 0, seen_.size(), size, is_kept, true, false, 0};
    const auto index = static_cast<std::uint32_t>(variables_.size());
    busbar::detail::Undo undo{[&] {
        account_->release(is_kept ? cost : 0);
        seen_.resize(added.seen);
        known_.erase(handle);
    }};
    seen_.resize(seen_.size() + (is_kept ? size : 0));
    known_.emplace(handle, index);
    variables_.push_back(added);
    undo.keep();
    charged_ += is_kept ? cost : 0;
    unused_bytes_ += is_kept ? size : 0;
    return index;
}

std::uint32_t ImageWatch::add(ValueItem& item, std::uint32_t handle)
{
    entries_.push_back({nullptr, 0, true, true, false});
    busbar::detail::Undo undo{[&] { entries_.pop_back(); }};
    const std::uint32_t index = variable_of(handle);
    undo.keep();
    Variable& variable = variables_[index];
    if (variable.users++ == 0 && variable.is_kept) {
        unused_bytes_ -= variable.bytes;
    }
    entries_.back().item = &item;
    entries_.back().variable = index;
    return static_cast<std::uint32_t>(entries_.size() - 1);
}

void ImageWatch::remove(std::size_t place)
{
    Entry& entry = entries_[place];
    entry.item = nullptr;
    ++holes_;
    const Variable& variable = variables_[entry.variable];
    if (--variables_[entry.variable].users == 0 && variable.is_kept) {
        unused_bytes_ += variable.bytes;
    }
}

bool ImageWatch::is_wasteful() const
{
    constexpr std::size_t few_places = 1'000;
    constexpr std::size_t few_bytes = 65'536;
    return (holes_ > few_places && holes_ > entries_.size() / 2) ||
           (unused_bytes_ > few_bytes && unused_bytes_ > seen_.size() / 2);
}

/// Compares once in a sample, however many items the variable has. While only new items are
/// sampled, a change stays new for the other items.
bool ImageWatch::has_changed(Variable& variable, const Sample& sample)
{
    if (!variable.is_kept) {
        return true;
    }
    if (variable.round == round_) {
        return variable.has_changed;
    }
    variable.round = round_;
    if (sample.is_only_new && !variable.is_fresh) {
        return variable.has_changed = true;
    }
    variable.is_fresh = false;
    const std::byte* const now = sample.pin.bytes(variable.handle);
    if (now == nullptr) { // it was added after the scan
        return variable.has_changed = true;
    }
    return variable.has_changed = take_new(seen_.data() + variable.seen, now, variable.bytes);
}

void ImageWatch::report(Entry& entry, const Sample& sample)
{
    ReadSlot slot{sample.status};
    if (sample.pin) {
        sample.pin.read(variables_[entry.variable].handle, slot);
        if (entry.item->range() != nullptr) {
            cut_range(slot, *entry.item->range());
        }
    }
    const StatusCode status = slot.status.is_bad() ? slot.status : sample.status;
    entry.item->sample(slot, status, sample.server_time);
    if (sample.pin) {
        sample.pin.recycle();
    }
    // The first value of an added variable may equal the initial bytes.
    entry.is_always =
        !entry.item->ignores_equal() || slot.status == status::Bad_WaitingForInitialData;
    entry.is_new = false;
}

void ImageWatch::note_loss()
{
    for (Entry& entry : entries_) {
        if (entry.item != nullptr) { // an item without any value has lost none
            entry.item->note_loss();
        }
    }
}

void ImageWatch::sample(const Sample& sample)
{
    const bool is_everything = sample.status != last_status_ && !sample.is_only_new;
    if (!sample.is_only_new) {
        last_status_ = sample.status;
    }
    ++round_;
    bool is_whole = true;
    // A group at a time: items are at different addresses, and all with a change are prefetched
    // while the rest of the group is compared.
    std::array<Entry*, 2 * busbar::detail::fetched_ahead> group;
    std::size_t count = 0;
    const auto report_group = [&] {
        const auto those = std::span{group}.first(std::exchange(count, 0));
        for (const Entry* const entry : those) {
            entry->item->fetch_queue();
        }
        for (Entry* const entry : those) {
            is_whole = try_report(*entry, sample) && is_whole;
        }
    };
    for (Entry& entry : entries_) {
        if (entry.item == nullptr || (sample.is_only_new && !entry.is_new)) {
            continue;
        }
        const bool has_new = sample.pin && has_changed(variables_[entry.variable], sample);
        if (has_new || is_everything || entry.is_always) {
            busbar::detail::fetch_object(*entry.item);
            group[count++] = &entry;
        }
        if (count == group.size()) {
            report_group();
        }
    }
    report_group();
    if (!is_whole) {
        report_left_out(sample);
    }
}

bool ImageWatch::try_report(Entry& entry, const Sample& sample)
{
    entry.is_left_out = busbar::detail::caught([&] { report(entry, sample); }).is_bad();
    entry.is_always |= entry.is_left_out; // a skipped value is still new for it
    return !entry.is_left_out;
}

/// Tries again, after the others were sampled; exceptions are passed on.
void ImageWatch::report_left_out(const Sample& sample)
{
    for (Entry& entry : entries_) {
        if (entry.item != nullptr && entry.is_left_out) {
            report(entry, sample);
            entry.is_left_out = false;
        }
    }
}

} // namespace busbar::server::detail
