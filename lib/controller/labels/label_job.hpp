#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_program.hpp>
#include <busbar/core/detail/hand_over.hpp>

#include "label_sampler.hpp"
#include "value_carry.hpp"

namespace busbar::controller::detail {

/// What goes from the server's thread, or from who replaces a program, to the PLC's, and back for
/// its memory to be freed. All that the PLC's thread needs is in it.
struct LabelJob {
    /// Null if it is no request but a change of the program or, without either, the end of
    /// sampling.
    std::unique_ptr<backend::LabelRequest> request{};
    /// Of the program that `steps` lie in.
    std::uint64_t generation{0};
    /// Which listener asks.
    std::uint64_t listener{0};
    /// Not Done: nothing is to be done, and this is the answer.
    backend::LabelStatus verdict{backend::LabelStatus::Done};
    /// Of a Read or Write.
    std::vector<LabelStep> steps{};
    std::size_t next_step{0};
    /// Of a Sample: the new one, null for none. Of a Write: the one that pauses.
    std::shared_ptr<LabelSampler> sampler{};
    /// The one that has been sampled before, which the PLC's thread does not free.
    std::shared_ptr<LabelSampler> ended_sampler{};
    /// Steps of that which the Write writes to.
    std::vector<std::uint32_t> paused{};
    /// Of a change.
    std::shared_ptr<LabelProgram> program{};
    std::vector<CarriedValue> carried{};

    /// Whoever has it.
    LabelJob* next{nullptr};
};

/// Jobs in a row, oldest first. For one thread; owns them and allocates nothing.
class LabelJobs {
public:
    LabelJobs() = default;
    /// `oldest` and what follows it.
    explicit LabelJobs(LabelJob* oldest) : front_{oldest}, back_{oldest}
    {
        while (back_ != nullptr && back_->next != nullptr) {
            back_ = back_->next;
        }
    }
    LabelJobs(LabelJobs&& other) noexcept
        : front_{std::exchange(other.front_, nullptr)}, back_{std::exchange(other.back_, nullptr)}
    {
    }
    LabelJobs& operator=(LabelJobs&&) = delete;
    ~LabelJobs()
    {
        while (!empty()) {
            pop();
        }
    }

    [[nodiscard]] bool empty() const { return front_ == nullptr; }
    [[nodiscard]] LabelJob& front() { return *front_; }
    std::unique_ptr<LabelJob> pop()
    {
        std::unique_ptr<LabelJob> job{front_};
        front_ = std::exchange(job->next, nullptr);
        return job;
    }
    void push(std::unique_ptr<LabelJob> job)
    {
        LabelJob* const added = job.release();
        (empty() ? front_ : back_->next) = added;
        back_ = added;
    }

private:
    LabelJob* front_{nullptr};
    LabelJob* back_{nullptr};
};

/// Jobs from threads to another one. Taking them is one step; giving one is repeated only if
/// another thread has given or taken in between. The taker looks without being woken.
class LabelHandover {
public:
    LabelHandover() = default;
    LabelHandover(const LabelHandover&) = delete;
    LabelHandover& operator=(const LabelHandover&) = delete;
    ~LabelHandover() { static_cast<void>(take_all()); }

    void give(std::unique_ptr<LabelJob> job) { static_cast<void>(given_.push(*job.release())); }
    /// In the order in which they were given.
    [[nodiscard]] LabelJobs take_all() { return LabelJobs{given_.take()}; }

private:
    busbar::detail::HandOver<LabelJob> given_;
};

} // namespace busbar::controller::detail
