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

namespace busbar::controller::detail {

/// Memory of a variable that keeps its value when a program is replaced.
struct CarriedValue {
    const std::byte* from;
    std::byte* to;
    std::size_t size;
};

/// A job for the PLC's thread, which returns it so that its memory is freed elsewhere. It comes
/// from the server's thread or from the thread that replaces a program, and contains all that the
/// PLC's thread needs.
struct LabelJob {
    /// Null if the job changes the program or, without a program, ends sampling.
    std::unique_ptr<backend::LabelRequest> request{};
    /// Generation of the program that `steps` point into.
    std::uint64_t generation{0};
    /// Number of the listener that receives the answer.
    std::uint64_t listener{0};
    /// If this is not Done, the PLC does nothing and answers with it.
    backend::LabelStatus verdict{backend::LabelStatus::Done};
    /// The values to read or write.
    std::vector<LabelStep> steps{};
    std::size_t next_step{0};
    /// For a Sample the new sampler, null for none; for a Write the sampler to pause.
    std::shared_ptr<LabelSampler> sampler{};
    /// The previous sampler, returned because the PLC's thread must not free it.
    std::shared_ptr<LabelSampler> ended_sampler{};
    /// Steps of `sampler` that the Write writes to.
    std::vector<std::uint32_t> paused{};
    /// The new program, if the job changes it.
    std::shared_ptr<LabelProgram> program{};
    std::vector<CarriedValue> carried{};

    /// Next job in the list that contains this one.
    LabelJob* next{nullptr};
};

/// A list of jobs, oldest first. Owned and used by one thread; never allocates.
class LabelJobs {
public:
    LabelJobs() = default;
    /// Takes over `oldest` and the jobs that follow it.
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

/// Hands jobs from several threads to another one. Taking them is one atomic step; giving one is
/// repeated only if another thread gave or took in between. Does not wake the taker, which polls.
class LabelHandover {
public:
    LabelHandover() = default;
    LabelHandover(const LabelHandover&) = delete;
    LabelHandover& operator=(const LabelHandover&) = delete;
    ~LabelHandover() { static_cast<void>(take_all()); }

    void give(std::unique_ptr<LabelJob> job) { static_cast<void>(given_.push(*job.release())); }
    /// Returns the jobs in the order in which they were given.
    [[nodiscard]] LabelJobs take_all() { return LabelJobs{given_.take()}; }

private:
    busbar::detail::HandOver<LabelJob> given_;
};

} // namespace busbar::controller::detail
