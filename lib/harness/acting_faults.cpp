#include "acting_faults.hpp"

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

} // namespace

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
