#include <busbar/harness/recording.hpp>

#include <utility>

namespace busbar::harness {

std::vector<std::byte> Recording::stream(std::uint32_t connection, Side from) const
{
    std::vector<std::byte> bytes;
    for (const Entry& entry : entries) {
        if (entry.kind == Kind::Bytes && entry.connection == connection && entry.from == from) {
            bytes.insert(bytes.end(), entry.bytes.begin(), entry.bytes.end());
        }
    }
    return bytes;
}

Recorder::Recorder(std::uint64_t seed, RecordingLimits limits) : limits_{limits}
{
    recording_.seed = seed;
}

void Recorder::opened(const Link& link)
{
    numbers_.erase(&link); // another link at the same address
    if (last_number_ == limits_.max_connections) {
        recording_.is_complete = false;
        return;
    }
    numbers_[&link] = ++last_number_;
    add(link, {Recording::Kind::Opened, {}, 0, Side::Client, {}});
}

void Recorder::arrived(const Link& link, Side from, std::span<const std::byte> bytes)
{
    add(link, {Recording::Kind::Bytes, {}, 0, from, {bytes.begin(), bytes.end()}});
}

void Recorder::ended(const Link& link, Side side)
{
    add(link, {Recording::Kind::Ended, {}, 0, side, {}});
}

void Recorder::add(const Link& link, Recording::Entry entry)
{
    const auto found = numbers_.find(&link);
    if (found == numbers_.end()) {
        return; // it was never open, or there were too many
    }
    if (!recording_.is_complete || recording_.entries.size() >= limits_.max_entries ||
        entry.bytes.size() > limits_.max_bytes - size_) {
        recording_.is_complete = false;
        return;
    }
    size_ += entry.bytes.size();
    entry.connection = found->second;
    entry.time = link.scheduler().now().time_since_epoch();
    recording_.entries.push_back(std::move(entry));
}

} // namespace busbar::harness
