#include "raised_event.hpp"

#include <algorithm>

#include <busbar/types/data_types.hpp>

namespace busbar::server::detail {

namespace {

/// In the order of BaseField.
constexpr std::array<std::string_view, base_field_count> base_names{
    "EventId",     "EventType", "SourceNode", "SourceName", "Time",
    "ReceiveTime", "Message",   "Severity",   "LocalTime",
};

constexpr std::uint16_t lowest_severity = 1;
constexpr std::uint16_t highest_severity = 1'000;

} // namespace

std::optional<BaseField> find_base_field(FieldPath path)
{
    if (path.size() != 1 || path[0].namespace_index != 0) {
        return std::nullopt;
    }
    const auto* const found = std::find(base_names.begin(), base_names.end(), path[0].name.view());
    return found == base_names.end()
               ? std::optional<BaseField>{}
               : BaseField{static_cast<std::uint8_t>(found - base_names.begin())};
}

RaisedEvent::RaisedEvent(Event event, model::NodeIndex type, ByteString event_id,
                         const Received& received)
    : type_{type}, source_node_{event.source_node},
      instance_{event.instance.is_null() ? Variant{} : Variant{std::move(event.instance)}},
      fields_{std::move(event.fields)}
{
    const auto set = [this](BaseField field, Variant value) {
        base_[static_cast<std::size_t>(field)] = std::move(value);
    };
    set(BaseField::EventId, std::move(event_id));
    set(BaseField::EventType, std::move(event.event_type));
    set(BaseField::SourceNode, std::move(event.source_node));
    set(BaseField::SourceName, std::move(event.source_name));
    set(BaseField::Time, event.time.is_null() ? received.time : event.time);
    set(BaseField::ReceiveTime, received.time);
    set(BaseField::Message, std::move(event.message));
    set(BaseField::Severity, std::clamp(event.severity, lowest_severity, highest_severity));
    set(BaseField::LocalTime, ExtensionObject::from(TimeZoneDataType{
                                  received.zone.offset, received.zone.daylight_saving_in_offset}));
}

const Variant* RaisedEvent::find(FieldPath path) const
{
    const auto found =
        std::find_if(fields_.begin(), fields_.end(), [path](const EventField& field) {
            return std::equal(field.path.begin(), field.path.end(), path.begin(), path.end());
        });
    return found == fields_.end() ? nullptr : &found->value;
}

} // namespace busbar::server::detail
