#include <array>
#include <cstdint>

#include <busbar/binary/codec.hpp>
#include <busbar/types/registry.hpp>

#include "fuzz_script.hpp"
#include "server/event/event_filter.hpp"

namespace event_filter_fuzz {

using namespace busbar;
using namespace busbar::server::detail;

namespace {

/// An event with fields of all kinds, its base fields as the script has them.
server::Event make_event(fuzz::Script& script)
{
    constexpr std::array types{id::BaseEventType, id::DeviceFailureEventType, id::AuditEventType,
                               id::AlarmConditionType};
    server::Event event;
    event.event_type = NodeId{0, types[script.byte() % types.size()]};
    event.severity = script.byte();
    const auto text = script.bytes(script.byte() % 32U);
    event.source_name =
        String{std::string_view{reinterpret_cast<const char*>(text.data()), text.size()}};
    event.message = LocalizedText{"en", event.source_name};
    event.set({0, "ActiveState"}, LocalizedText{"Active"})
        .set({{0, "ActiveState"}, {0, "Id"}}, true)
        .set({0, "Retain"}, status::Bad_NotSupported)
        .set({0, "Quality"}, status::Uncertain_LastUsableValue)
        .set({0, "Comment"}, Variant{})
        .set({0, "Status"}, Array<double>{1.5, 2.5});
    return event;
}

} // namespace

/// The script begins with an event; the rest is an EventFilter on the wire.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    static const model::AddressSpace space;
    static const binary::TypeRegistry types{binary::namespace0_types()};
    fuzz::Script script{{data, size}};
    server::Event event = make_event(script);
    const auto wire = script.bytes(size);
    EventFilter filter;
    binary::Reader reader{wire, binary::Strings::Borrow, &types};
    decode(reader, filter);
    if (!reader.ok()) {
        return 0;
    }
    static EventFields fields{space};
    EventFilterResult result;
    CompiledEventFilter compiled;
    if (compiled.compile(filter, fields, {}, result).is_good()) {
        const model::NodeIndex type = space.find(event.event_type);
        const RaisedEvent raised{std::move(event), type, ByteString{}, {DateTime{1}}};
        const bool is_passed = compiled.matches(raised, space);
        // What it selects and whether it matches depends on nothing but the event.
        if (compiled.matches(raised, space) != is_passed ||
            compiled.select(raised, space).size() != filter.select_clauses.size()) {
            __builtin_trap();
        }
    }
    return 0;
}

} // namespace event_filter_fuzz
