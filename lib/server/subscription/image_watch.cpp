#include "image_watch.hpp"

#include <cstring>

#include "server/data/read_results.hpp"

namespace busbar::server::detail {

namespace {

bool is_same(const std::byte* a, const std::byte* b, std::size_t size)
{
    switch (size) { // sizes that are known need no call
    case 1:
        return *a == *b;
    case 2:
        return std::memcmp(a, b, 2) == 0;
    case 4:
        return std::memcmp(a, b, 4) == 0;
    case 8:
        return std::memcmp(a, b, 8) == 0;
    default:
        return std::memcmp(a, b, size) == 0;
    }
}

} // namespace

std::uint32_t ImageWatch::add(DataItem& item, std::uint32_t handle)
{
    const std::uint32_t size = (*layout_)[handle].bytes();
    entries_.push_back({&item, handle, static_cast<std::uint32_t>(seen_.size()), size, true, true});
    seen_.resize(seen_.size() + size);
    return static_cast<std::uint32_t>(entries_.size() - 1);
}

bool ImageWatch::has_changed(const Entry& entry, const std::byte* now)
{
    std::byte* const seen = seen_.data() + entry.seen;
    if (is_same(now, seen, entry.size)) {
        return false;
    }
    std::memcpy(seen, now, entry.size);
    return true;
}

void ImageWatch::report(Entry& entry, const Sample& sample)
{
    ReadSlot slot{sample.status};
    if (sample.pin) {
        sample.pin.read(entry.handle, slot);
        if (entry.item->range() != nullptr) {
            cut_range(slot, *entry.item->range());
        }
    }
    const StatusCode status = slot.status.is_bad() ? slot.status : sample.status;
    entry.item->sample(slot, status, sample.server_time);
    entry.is_always = !entry.item->ignores_equal();
    entry.is_new = false;
}

void ImageWatch::note_loss()
{
    for (Entry& entry : entries_) {
        if (entry.item != nullptr) { // one without any value yet has lost none
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
    for (Entry& entry : entries_) {
        if (entry.item == nullptr || (sample.is_only_new && !entry.is_new)) {
            continue;
        }
        const bool has_new =
            sample.pin && has_changed(entry, sample.pin.bytes((*layout_)[entry.handle]));
        if (has_new || is_everything || entry.is_always) {
            report(entry, sample);
        }
    }
}

} // namespace busbar::server::detail
