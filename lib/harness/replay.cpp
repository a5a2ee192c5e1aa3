#include <busbar/harness/replay.hpp>

#include <algorithm>
#include <utility>

#include "dissector.hpp"

namespace busbar::harness {

namespace {

/// Returns the message of the stream that contains the byte, as "MSG 3 (ReadResponse), byte 60".
std::string place_of(const std::vector<std::byte>& stream, Side from, std::size_t offset)
{
    detail::Dissector dissector;
    dissector.feed(from, stream);
    std::size_t begin = 0;
    std::size_t number = 0;
    while (const auto frame = dissector.take(from)) {
        ++number;
        if (offset < begin + frame->bytes.size()) {
            std::string text =
                "frame " + std::to_string(number) + ", " + std::string{frame->type_name};
            if (!frame->structure_name.empty()) {
                text += " " + std::string{frame->structure_name};
            }
            return text + ", byte " + std::to_string(offset - begin);
        }
        begin += frame->bytes.size();
    }
    return "after frame " + std::to_string(number);
}

} // namespace

Replay::Replay(World& world, const Recording& recording, Side played, std::uint32_t connection)
    : world_{world}, seed_{recording.seed}, played_{played},
      expected_{recording.stream(connection, other(played))}, sending_{world.scheduler(),
                                                                       [this] { send_due(); }}
{
    for (const Recording::Entry& entry : recording.entries) {
        if (entry.connection != connection) {
            continue;
        }
        if (entry.kind == Recording::Kind::Opened) {
            opened_ = TimePoint{entry.time};
        } else if (entry.from == played) {
            entries_.push_back(entry);
        }
    }
}

Replay::~Replay()
{
    if (link_ != nullptr) {
        link_->leave(played_);
    }
}

TimePoint Replay::time_of(const Recording::Entry& entry) const
{
    return TimePoint{entry.time + shift_};
}

Result<void> Replay::run(std::string_view url)
{
    world_.run_until(std::max(opened_, world_.now()));
    auto link = world_.network().connect(url, *this);
    if (!link) {
        return fail(link.error());
    }
    begin(*std::move(link));
    const TimePoint end = entries_.empty() ? world_.now() : time_of(entries_.back());
    constexpr Duration rest = std::chrono::seconds{1};
    world_.run_until(end + 2 * world_.network().weather().max_latency + rest);
    return {};
}

bool Replay::accept(const std::shared_ptr<Link>& link, std::string_view /*peer_address*/)
{
    if (link_ != nullptr || played_ != Side::Server) {
        return false;
    }
    link->attach(played_, *this);
    begin(link);
    return true;
}

void Replay::begin(std::shared_ptr<Link> link)
{
    link_ = std::move(link);
    shift_ = world_.now() - opened_;
    send_due();
}

void Replay::send_due()
{
    // The recorded times are those of arrival.
    const Duration back = -world_.network().weather().max_latency;
    while (link_ != nullptr && next_ < entries_.size() &&
           time_of(entries_[next_]) <= world_.now()) {
        const Recording::Entry& entry = entries_[next_++];
        if (entry.kind == Recording::Kind::Bytes) {
            link_->send(played_, entry.bytes, back);
        } else {
            std::exchange(link_, nullptr)->close(played_);
        }
    }
    if (link_ != nullptr && next_ < entries_.size()) {
        sending_.set(time_of(entries_[next_]));
    }
}

void Replay::feed(std::span<const std::byte> in)
{
    // The recorded side closed without waiting for further bytes.
    const bool has_left = next_ + 1 >= entries_.size() &&
                          (entries_.empty() || entries_.back().kind == Recording::Kind::Ended);
    if (has_left && came_.size() == expected_.size()) {
        return;
    }
    // One byte too many is enough to detect a difference.
    const std::size_t room = expected_.size() + 1 - std::min(expected_.size() + 1, came_.size());
    const auto kept = in.first(std::min(in.size(), room));
    came_.insert(came_.end(), kept.begin(), kept.end());
}

bool Replay::is_over() const
{
    return next_ == entries_.size() && came_.size() >= expected_.size();
}

std::string Replay::difference() const
{
    std::string text = first_difference();
    if (!text.empty() && seed_ != world_.seed()) {
        text += "; the recording has the seed " + std::to_string(seed_) + ", the world " +
                std::to_string(world_.seed());
    }
    return text;
}

std::string Replay::first_difference() const
{
    const std::size_t common = std::min(came_.size(), expected_.size());
    const auto end = came_.begin() + static_cast<std::ptrdiff_t>(common);
    const auto at = std::mismatch(came_.begin(), end, expected_.begin()).first;
    const auto offset = static_cast<std::size_t>(at - came_.begin());
    if (offset == common && came_.size() <= expected_.size()) {
        return came_.size() < expected_.size() && next_ == entries_.size() && link_ == nullptr
                   ? "it ends at " + place_of(expected_, other(played_), offset)
                   : std::string{};
    }
    return "another byte at " +
           place_of(offset < expected_.size() ? expected_ : came_, other(played_), offset);
}

} // namespace busbar::harness
