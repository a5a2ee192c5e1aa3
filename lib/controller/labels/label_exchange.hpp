#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_program.hpp>
#include <busbar/core/detail/hand_over.hpp>

#include "label_job.hpp"

namespace busbar::controller::detail {

/// The listener that is told of answers. set() waits until calls to the previous one have returned.
class LabelListenerSlot {
public:
    /// Replaces the listener and gives it a new number. Called by the server's thread.
    void set(backend::LabelListener* listener);
    /// The listener's number. Called by the server's thread.
    [[nodiscard]] std::uint64_t number() const { return number_.load(std::memory_order_relaxed); }

    // For any thread.

    [[nodiscard]] bool is_current(std::uint64_t number) const
    {
        return number_.load(std::memory_order_relaxed) == number;
    }
    /// Passes the request on if the listener of that number is still attached.
    void done(std::unique_ptr<backend::LabelRequest>& request, std::uint64_t number);
    void labels_changed();

private:
    busbar::detail::Lent<backend::LabelListener> listener_;
    std::atomic<std::uint64_t> number_{0};
};

/// The state that the threads of SimulatedLabels share.
struct LabelExchange {
    LabelHandover to_plc{};
    /// Jobs that the PLC's thread no longer needs; the other threads free them.
    LabelHandover to_server{};
    /// Requests that the PLC has not answered.
    std::atomic<std::size_t> waiting{0};
    std::atomic<backend::LabelStatus> fault{backend::LabelStatus::Done};
    LabelListenerSlot listener{};

    /// Locked while a program is replaced, so that replacements happen one after another.
    std::mutex replacing{};
    /// Guards the members below, and ensures that nothing is given to a PLC that has been halted.
    /// Never locked in end_of_scan().
    std::mutex mutex{};
    std::shared_ptr<LabelProgram> program{};
    /// See SimulatedLabelsOptions.
    Unserved unserved{Unserved::Refuse};
    /// Number of the program; grows with each replacement.
    std::uint64_t generation{1};
    std::atomic<bool> is_halted{false};
};

} // namespace busbar::controller::detail
