#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include <busbar/core/clock.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/event.hpp>

namespace busbar::server::detail {

/// The fields that every event of this server has (Part 5, 6.4.2).
enum class BaseField : std::uint8_t {
    EventId,
    EventType,
    SourceNode,
    SourceName,
    Time,
    ReceiveTime,
    Message,
    Severity,
    LocalTime,
};
inline constexpr std::size_t base_field_count = 9;

using FieldPath = std::span<const QualifiedName>;

[[nodiscard]] std::optional<BaseField> find_base_field(FieldPath path);

/// The time when the server got an event, and its place in the order.
struct Received {
    DateTime time;
    TimeZone zone{};
};

/// An Event in the form for filters: with its type looked up and each field as a ready Variant.
/// Belongs to the server's thread.
class RaisedEvent {
public:
    /// `type` is the node of `event.event_type`.
    RaisedEvent(Event event, model::NodeIndex type, ByteString event_id, const Received& received);
    RaisedEvent(const RaisedEvent&) = delete;
    RaisedEvent& operator=(const RaisedEvent&) = delete;

    [[nodiscard]] model::NodeIndex type() const { return type_; }
    [[nodiscard]] const NodeId& source_node() const { return source_node_; }
    [[nodiscard]] const Variant& operator[](BaseField field) const
    {
        return base_[static_cast<std::size_t>(field)];
    }
    /// Returns a field beyond the base; null if the event does not have it.
    [[nodiscard]] const Variant* find(FieldPath path) const;
    /// Returns the NodeId of the event's node; a null Variant if it has none.
    [[nodiscard]] const Variant& instance() const { return instance_; }

private:
    model::NodeIndex type_;
    NodeId source_node_;
    std::array<Variant, base_field_count> base_;
    Variant instance_;
    std::vector<EventField> fields_;
};

} // namespace busbar::server::detail
