#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <string>

#include <busbar/harness/fault.hpp>
#include <busbar/harness/jumping_clock.hpp>

#include "chunks.hpp"
#include "timeline.hpp"

namespace busbar::harness::detail {

/// Returns whether the fault acts on a whole message.
[[nodiscard]] bool acts_on_messages(Fault::Kind kind);
/// Returns whether it acts on bytes that are sent, and not on their connection.
[[nodiscard]] bool acts_on_bytes(Fault::Kind kind);
/// Returns why the fault could never act, wherever it is played; empty if it could.
[[nodiscard]] std::string flaw_of(const Fault& fault);

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

    ActingFaults(JumpingClock& clock, std::shared_ptr<Timeline> timeline,
                 std::shared_ptr<ChunkTap> tap)
        : clock_{&clock}, timeline_{std::move(timeline)}, tap_{std::move(tap)}
    {
    }

    void add(const Fault& fault) { entries_.push_back(Entry{fault}); }
    [[nodiscard]] std::deque<Entry>& entries() { return entries_; }
    /// The fault acts, on this connection; 0: on no single one.
    void count(Entry& entry, std::size_t connection);
    [[nodiscard]] Timeline& timeline() const { return *timeline_; }
    [[nodiscard]] ChunkTap& tap() const { return *tap_; }
    /// Lets the fault act on the link, when the bytes that `from` has sent have arrived. Not for
    /// faults that act on bytes. Does not count it.
    void act(const Fault& fault, Link& link, Side from);
    void jump(Duration by) { clock_->jump(by); }
    [[nodiscard]] DateTime now() const { return clock_->now(); }
    [[nodiscard]] std::string pending() const;

private:
    JumpingClock* clock_;
    std::shared_ptr<Timeline> timeline_;
    std::shared_ptr<ChunkTap> tap_;
    std::deque<Entry> entries_;
};

} // namespace busbar::harness::detail
