#include "notification_message.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include <busbar/binary/codec.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/types/subscription.hpp>

namespace busbar::server::detail {

namespace {

/// Writes a NotificationMessage whose counts and lengths are known only at its end: their places
/// are reserved and filled in then.
class MessageWriter {
public:
    MessageWriter(std::uint32_t sequence_number, DateTime publish_time)
    {
        make_room(frame);
        writer_->number(sequence_number);
        encode(*writer_, publish_time);
        parts_place_ = reserve();
    }

    /// Writes one part with the Notifications of a list's items, as far as the limits allow.
    void write_part(std::uint32_t encoding_id, ReadyList& list, bool has_diagnostics,
                    const MessageLimits& limits)
    {
        if (list.empty() || is_full(list.front().notification_size(), limits)) {
            return;
        }
        const std::size_t begin = written();
        const StatusCode thrown = busbar::detail::caught([&] { make_room(2 * frame); });
        if (thrown.is_bad()) {
            return lack(thrown);
        }
        encode(*writer_, NodeId{0, encoding_id});
        writer_->number(std::uint8_t{1}); // a ByteString (Part 6, 5.2.2.15)
        const std::size_t length_place = reserve();
        const std::size_t count_place = reserve();
        const std::size_t before = notifications_;
        write_notifications(list, limits);
        if (notifications_ == before) {
            return cut(begin);
        }
        if (has_diagnostics) {
            writer_->number(std::int32_t{-1});
        }
        fill(count_place, notifications_ - before);
        fill(length_place, written() - count_place);
        ++parts_;
    }

    [[nodiscard]] Result<std::vector<std::byte>> finish()
    {
        if (!writer_->ok()) {
            return fail(writer_->status());
        }
        if (notifications_ == 0 && lack_.is_bad()) {
            return fail(lack_);
        }
        fill(parts_place_, parts_);
        bytes_.resize(written());
        for (std::size_t i = 0; i < patch_count_; ++i) {
            binary::SpanSink place{std::span{bytes_}.subspan(patches_[i].place, 4)};
            binary::Writer{place}.length(patches_[i].number);
        }
        return std::move(bytes_);
    }

private:
    static constexpr std::size_t frame = 32; // of a new part

    struct Patch {
        std::size_t place;
        std::size_t number;
    };

    void write_notifications(ReadyList& list, const MessageLimits& limits)
    {
        MonitoredItem* item = nullptr;
        std::size_t end = written();
        const StatusCode thrown = busbar::detail::caught([&] {
            std::size_t size = list.front().notification_size();
            do {
                make_room(size + frame);
                item = &list.take_notification(*writer_, room(limits));
                ++notifications_;
                end = written();
                size = list.empty() ? 0 : list.front().notification_size();
            } while (!list.empty() && !is_full(size, limits));
        });
        if (thrown.is_bad()) {
            cut(end);
            lack(thrown);
        }
        if (item != nullptr) {
            list.end_turn(*item);
        }
    }
    /// Returns whether a Notification of this size does not fit any more.
    [[nodiscard]] bool is_full(std::size_t size, const MessageLimits& limits) const
    {
        if (lack_.is_bad()) {
            return true;
        }
        if (notifications_ == 0) {
            return false;
        }
        return !writer_->ok() || written() + frame + size > limits.bytes ||
               (limits.notifications != 0 && notifications_ >= limits.notifications);
    }
    /// Returns the maximum size of one more Notification.
    [[nodiscard]] std::size_t room(const MessageLimits& limits) const
    {
        const std::size_t used = written() + frame;
        return limits.most_bytes > used ? limits.most_bytes - used : 0;
    }
    [[nodiscard]] std::size_t written() const { return before_ + writer_->written(); }
    /// Makes sure that this many bytes can be written without allocation.
    void make_room(std::size_t size)
    {
        const std::size_t end = writer_ ? written() : 0;
        if (bytes_.size() - end < size) {
            bytes_.resize(std::max({end + size, 2 * bytes_.size(), smallest}));
            cut(end);
        }
    }
    /// Removes everything that was written from there on.
    void cut(std::size_t end)
    {
        before_ = end;
        block_.emplace(std::span{bytes_}.subspan(end));
        writer_.emplace(*block_);
    }
    void lack(StatusCode status) { lack_ = status; }
    std::size_t reserve()
    {
        const std::size_t place = written();
        writer_->length(0);
        return place;
    }
    void fill(std::size_t place, std::size_t number) { patches_[patch_count_++] = {place, number}; }

    static constexpr std::size_t smallest = 256;

    std::vector<std::byte> bytes_;
    /// The rest of them, and the bytes before it.
    std::optional<binary::SpanSink> block_;
    std::optional<binary::Writer> writer_;
    std::size_t before_{0};
    std::size_t parts_place_{0};
    std::size_t parts_{0};
    std::size_t notifications_{0};
    /// The reason why no more can be written.
    StatusCode lack_;
    std::array<Patch, 5> patches_{};
    std::size_t patch_count_{0};
};

std::vector<std::byte> to_bytes(const NotificationMessage& message)
{
    return binary::to_bytes(message).value_or(std::vector<std::byte>{});
}

} // namespace

Result<std::vector<std::byte>> write_notifications(std::uint32_t sequence_number,
                                                   DateTime publish_time, ReadyList& data,
                                                   ReadyList& events, const MessageLimits& limits,
                                                   bool& events_first)
{
    MessageWriter message{sequence_number, publish_time};
    const auto write_events = [&] {
        message.write_part(EventNotificationList::binary_encoding_id, events, false, limits);
    };
    const bool begins_with_events = events_first;
    if (begins_with_events) {
        write_events();
    }
    message.write_part(DataChangeNotification::binary_encoding_id, data, true, limits);
    if (!begins_with_events) {
        write_events();
    }
    events_first = !begins_with_events && !events.empty();
    return message.finish();
}

std::vector<std::byte> write_keep_alive(std::uint32_t sequence_number, DateTime publish_time)
{
    return to_bytes({sequence_number, publish_time, {}});
}

std::vector<std::byte> write_status_change(std::uint32_t sequence_number, DateTime publish_time,
                                           StatusCode status)
{
    StatusChangeNotification change;
    change.status = status;
    return to_bytes({sequence_number, publish_time, {ExtensionObject::from(change)}});
}

} // namespace busbar::server::detail
