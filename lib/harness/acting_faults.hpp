#pragma once

#include <cstddef>
#include <deque>
#include <string>

#include <busbar/harness/fault.hpp>
#include <busbar/harness/jumping_clock.hpp>

namespace busbar::harness::detail {

/// The faults that were played on a network, and how often each may still act.
class ActingFaults {
public:
    struct Entry {
        Fault fault;
        std::size_t acted{0};

        [[nodiscard]] bool is_over() const { return fault.count != 0 && acted >= fault.count; }
        /// Returns whether it may act on this connection.
        [[nodiscard]] bool is_for(std::size_t connection) const
        {
            return !is_over() && (fault.connection == 0 || fault.connection == connection);
        }
    };

    explicit ActingFaults(JumpingClock& clock) : clock_{&clock} {}

    /// Adds the fault and returns its entry, which keeps its address.
    Entry& add(const Fault& fault) { return entries_.emplace_back(Entry{fault}); }
    [[nodiscard]] std::deque<Entry>& entries() { return entries_; }
    /// Lets the fault act on the link, when the bytes that `from` has sent have arrived. Not for
    /// faults that act on bytes: Delay, Corrupt, Answer. Does not count it.
    void act(const Fault& fault, Link& link, Side from);
    void jump(Duration by) { clock_->jump(by); }
    [[nodiscard]] DateTime now() const { return clock_->now(); }
    [[nodiscard]] std::string pending() const;

private:
    JumpingClock* clock_;
    std::deque<Entry> entries_;
};

} // namespace busbar::harness::detail
