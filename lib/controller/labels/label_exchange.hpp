#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_program.hpp>

#include "label_job.hpp"

namespace busbar::controller::detail {

/// Who is told of answers. Whoever calls it does so between two steps of a counter, so that set()
/// can wait for the end of what the listener before is being told.
class LabelListenerSlot {
public:
    /// For the server's thread. From now on the listener has another number.
    void set(backend::LabelListener* listener);
    /// For the server's thread, too.
    [[nodiscard]] std::uint64_t number() const { return number_.load(std::memory_order_relaxed); }

    // For any thread.

    [[nodiscard]] bool is_current(std::uint64_t number) const
    {
        return number_.load(std::memory_order_relaxed) == number;
    }
    /// Takes the request if the listener of that number is still there.
    void done(std::unique_ptr<backend::LabelRequest>& request, std::uint64_t number);
    void labels_changed();

private:
    std::atomic<backend::LabelListener*> listener_{nullptr};
    std::atomic<std::uint64_t> number_{0};
    std::atomic<std::uint32_t> callers_{0};
};

/// What the threads of SimulatedLabels share.
struct LabelExchange {
    LabelHandover to_plc{};
    /// What the PLC's thread needs no more; freed by all others.
    LabelHandover to_server{};
    /// Requests that the PLC has not answered.
    std::atomic<std::size_t> waiting{0};
    std::atomic<backend::LabelStatus> fault{backend::LabelStatus::Done};
    LabelListenerSlot listener{};

    /// Held by who replaces the program, so that one after another does.
    std::mutex replacing{};
    /// Guards what follows, and that nothing is given to a PLC that has been halted. Never taken in
    /// end_of_scan().
    std::mutex mutex{};
    std::shared_ptr<LabelProgram> program{};
    /// Of the program; grows with each that takes the place of another.
    std::uint64_t generation{1};
    std::atomic<bool> is_halted{false};
};

} // namespace busbar::controller::detail
