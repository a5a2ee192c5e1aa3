#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "acting_faults.hpp"
#include "dissector.hpp"

namespace busbar::harness::detail {

/// Lets faults act on the bytes of one connection.
class FaultFilter final : public LinkFilter {
public:
    FaultFilter(std::shared_ptr<ActingFaults> faults, std::size_t connection)
        : faults_{std::move(faults)}, connection_{connection}, dissector_{&faults_->tap()}
    {
    }

    void pass(Link& link, Side from, std::span<const std::byte> bytes) override;

private:
    using Entry = ActingFaults::Entry;
    struct Stream {
        std::uint64_t sent{0};
        /// Faults that act at the end of the present message.
        std::vector<Entry*> at_end;
        /// Number of messages with the fault's name so far, by the fault's place.
        std::vector<std::size_t> matches;
        Duration delay{0};
        bool is_swallowed{false};
        /// Faults that act on the whole of the present message, and its chunks so far.
        std::vector<Entry*> on_message;
        std::vector<DissectedFrame> frames;
        /// The message that the next one overtakes.
        std::vector<DissectedFrame> overtaken;
    };

    void pass(Link& link, Side from, DissectedFrame frame);
    void renumber(Side from, DissectedFrame& frame);
    /// Lets the faults act whose message begins with the frame.
    void begin_message(Link& link, Side from, DissectedFrame& frame);
    void meet(Link& link, Side from, DissectedFrame& frame, Entry& entry);
    void act_on_message(Link& link, Side from);
    void let_go_of_endless(Link& link, Side from);
    void end_message(Link& link, Side from);
    void send(Link& link, Side from, std::span<std::byte> bytes);
    [[nodiscard]] Entry* next_at_byte(Side from, std::size_t size);
    void answer(Link& link, const DissectedFrame& request, StatusCode status);

    std::shared_ptr<ActingFaults> faults_;
    std::size_t connection_;
    Dissector dissector_;
    Stream streams_[2];
    /// Added to the numbers of each side's chunks, since some never arrived and
    /// others were not its own; and the server's last number.
    std::uint32_t shift_[2]{};
    std::uint32_t server_number_{0};
};

} // namespace busbar::harness::detail
