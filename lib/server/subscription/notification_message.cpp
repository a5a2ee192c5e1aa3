#include "notification_message.hpp"

#include <array>

#include <busbar/binary/codec.hpp>
#include <busbar/types/subscription.hpp>

namespace busbar::server::detail {

namespace {

/// Writes a NotificationMessage whose counts and lengths are only known at its end: their places
/// are kept and filled in then.
class MessageWriter {
public:
    MessageWriter(std::uint32_t sequence_number, DateTime publish_time)
    {
        writer_.number(sequence_number);
        encode(writer_, publish_time);
        parts_place_ = reserve();
    }

    /// One part with what the items of a list have, while there is any allowed.
    void write_part(std::uint32_t encoding_id, ReadyList& list, bool has_diagnostics,
                    const MessageLimits& limits)
    {
        if (list.empty() || is_full(list, limits)) {
            return;
        }
        encode(writer_, NodeId{0, encoding_id});
        writer_.number(std::uint8_t{1}); // a ByteString (Part 6, 5.2.2.15)
        const std::size_t length_place = reserve();
        const std::size_t count_place = reserve();
        const std::size_t before = notifications_;
        MonitoredItem* item = nullptr;
        do {
            item = &list.take_notification(writer_, room(limits));
            ++notifications_;
        } while (!list.empty() && !is_full(list, limits));
        list.end_turn(*item);
        if (has_diagnostics) {
            writer_.number(std::int32_t{-1});
        }
        fill(count_place, notifications_ - before);
        fill(length_place, writer_.written() - count_place);
        ++parts_;
    }

    [[nodiscard]] Result<std::vector<std::byte>> finish()
    {
        if (!writer_.ok()) {
            return fail(writer_.status());
        }
        fill(parts_place_, parts_);
        std::vector<std::byte> bytes = sink_.take(writer_.written());
        for (std::size_t i = 0; i < patch_count_; ++i) {
            binary::SpanSink place{std::span{bytes}.subspan(patches_[i].place, 4)};
            binary::Writer{place}.length(patches_[i].number);
        }
        return bytes;
    }

private:
    static constexpr std::size_t frame = 32; // of a part that begins

    struct Patch {
        std::size_t place;
        std::size_t number;
    };

    [[nodiscard]] bool is_full(const ReadyList& list, const MessageLimits& limits) const
    {
        if (notifications_ == 0) {
            return false;
        }
        return !writer_.ok() ||
               writer_.written() + frame + list.front().notification_size() > limits.bytes ||
               (limits.notifications != 0 && notifications_ >= limits.notifications);
    }
    /// Bytes that one more Notification may have.
    [[nodiscard]] std::size_t room(const MessageLimits& limits) const
    {
        const std::size_t used = writer_.written() + frame;
        return limits.most_bytes > used ? limits.most_bytes - used : 0;
    }
    std::size_t reserve()
    {
        const std::size_t place = writer_.written();
        writer_.length(0);
        return place;
    }
    void fill(std::size_t place, std::size_t number) { patches_[patch_count_++] = {place, number}; }

    binary::VectorSink sink_;
    binary::Writer writer_{sink_};
    std::size_t parts_place_{0};
    std::size_t parts_{0};
    std::size_t notifications_{0};
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
