#include "acting_faults.hpp"

#include <algorithm>
#include <array>

#include <busbar/binary/type_registry.hpp>
#include <busbar/types/registry.hpp>

namespace busbar::harness::detail {

namespace {

void hold(Link& link, Side side, Duration time)
{
    link.hold(side);
    if (time != Duration{0}) {
        link.scheduler().after(time,
                               [kept = link.shared_from_this(), side] { kept->release(side); });
    }
}

void hold(Link& link, const Fault& fault)
{
    for (const Side side : {Side::Client, Side::Server}) {
        if (!fault.side || *fault.side == side) {
            hold(link, side, fault.duration);
        }
    }
}

bool is_message_name(std::string_view name)
{
    static constexpr std::array<std::string_view, 7> types{"HEL", "ACK", "ERR", "RHE",
                                                           "OPN", "MSG", "CLO"};
    const auto structures = binary::namespace0_types();
    return std::find(types.begin(), types.end(), name) != types.end() ||
           std::any_of(structures.begin(), structures.end(),
                       [&](const StructureType* type) { return type->name == name; });
}

std::string flaw_of_message(const Fault& fault)
{
    const Message& message = *fault.message;
    if (!is_message_name(message.name)) {
        return "no message is called \"" + message.name + "\"";
    }
    if (message.number == 0) {
        return "messages are counted from 1";
    }
    if (acts_on_bytes(fault.kind) && fault.moment == Fault::Moment::After) {
        return "after its message has been sent, nothing can be done to it; say at()";
    }
    if (fault.kind == Fault::Kind::Answer &&
        (!message.name.ends_with("Request") || fault.side == Side::Server)) {
        return "only requests, which clients send, can be answered";
    }
    return {};
}

std::string flaw_of_numbers(const Fault& fault)
{
    using enum Fault::Kind;
    const bool is_early = fault.time && *fault.time < Duration{0};
    if (is_early || (fault.duration < Duration{0} && fault.kind != JumpClock)) {
        return "its time is negative";
    }
    if (fault.kind == Delay && fault.duration == Duration{0}) {
        return "a delay of no time is none";
    }
    if (fault.kind == Split && fault.position == 0) {
        return "pieces have at least one byte";
    }
    return {};
}

} // namespace

bool acts_on_messages(Fault::Kind kind)
{
    using enum Fault::Kind;
    return kind == Drop || kind == Duplicate || kind == Overtake || kind == Change;
}

bool acts_on_bytes(Fault::Kind kind)
{
    using enum Fault::Kind;
    return kind == Delay || kind == Corrupt || kind == Answer || acts_on_messages(kind);
}

std::string flaw_of(const Fault& fault)
{
    using enum Fault::Kind;
    if (std::string flaw = flaw_of_numbers(fault); !flaw.empty()) {
        return flaw;
    }
    const int times = (fault.message ? 1 : 0) + (fault.byte_offset ? 1 : 0) + (fault.time ? 1 : 0);
    if (times > 1) {
        return "it has more than one time";
    }
    if (fault.kind == Refuse) {
        return times == 0 ? "" : "it refuses the next connections, at no other time";
    }
    if (acts_on_bytes(fault.kind) && !fault.message && !fault.byte_offset) {
        return "it acts on a message or a byte, and neither is said";
    }
    if (fault.kind == Answer && !fault.message) {
        return "only a message can be answered";
    }
    if (acts_on_messages(fault.kind) && !fault.message) {
        return "it acts on a message, and none is said";
    }
    if (fault.kind == Change && !fault.edit) {
        return "nothing says what shall change";
    }
    return fault.message ? flaw_of_message(fault) : std::string{};
}

void ActingFaults::act(const Fault& fault, Link& link, Side from)
{
    if (fault.kind == Fault::Kind::Split) {
        link.split(fault.position);
        return;
    }
    // The fault does not affect bytes that were sent before; later ones arrive after it.
    link.scheduler().at(link.last_arrival(from), [this, fault, kept = link.shared_from_this()] {
        switch (fault.kind) {
        case Fault::Kind::Cut:
            kept->cut();
            break;
        case Fault::Kind::HalfOpen:
            kept->cut_for(fault.side.value_or(Side::Client));
            break;
        case Fault::Kind::Hold:
            hold(*kept, fault);
            break;
        case Fault::Kind::JumpClock:
            clock_->jump(fault.duration);
            break;
        default:
            break;
        }
    });
}

void ActingFaults::count(Entry& entry, std::size_t connection)
{
    ++entry.acted;
    timeline_->happened(connection, describe(entry.fault));
}

std::string ActingFaults::pending() const
{
    std::string text;
    for (const Entry& entry : entries_) {
        if (entry.acted == 0) {
            text += describe(entry.fault) + "\n";
        }
    }
    return text;
}

} // namespace busbar::harness::detail
