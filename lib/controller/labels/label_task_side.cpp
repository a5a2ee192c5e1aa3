#include "label_task_side.hpp"

#include <cstring>
#include <utility>

#include "label_sampler.hpp"

namespace busbar::controller::detail {

using backend::LabelRequest;
using backend::LabelStatus;

LabelTaskSide::LabelTaskSide(LabelExchange& exchange, const SimulatedLabelsOptions& options)
    : exchange_{&exchange}, access_unit_{options.access_unit}, program_{exchange.program},
      generation_{exchange.generation}
{
}

void LabelTaskSide::end_of_scan(DateTime now)
{
    exchange_->is_halted.store(false, std::memory_order_relaxed);
    ++scan_;
    accept();
    serve(now);
    if (sampler_ != nullptr &&
        exchange_->fault.load(std::memory_order_relaxed) == LabelStatus::Done) {
        sampler_->sample(scan_, now);
    }
}

void LabelTaskSide::halt(DateTime now)
{
    {
        const std::lock_guard lock{exchange_->mutex};
        exchange_->is_halted.store(true, std::memory_order_relaxed);
    }
    accept();
    while (!waiting_.empty()) {
        waiting_.front().verdict = LabelStatus::NoCommunication;
        finish(now);
    }
}

void LabelTaskSide::accept()
{
    LabelJobs arrived = exchange_->to_plc.take_all();
    while (!arrived.empty()) {
        auto job = arrived.pop();
        if (job->request == nullptr) {
            change(*job);
            exchange_->to_server.give(std::move(job));
            continue;
        }
        if (!job->paused.empty()) {
            job->sampler->pause(job->paused);
        }
        waiting_.push(std::move(job));
    }
}

/// Moves replaced objects into the job, because other threads must free them.
void LabelTaskSide::change(LabelJob& job)
{
    job.ended_sampler = std::move(sampler_);
    if (job.program == nullptr) {
        return;
    }
    for (const CarriedValue& value : job.carried) {
        std::memcpy(value.to, value.from, value.size);
    }
    std::swap(program_, job.program);
    generation_ = job.generation;
}

void LabelTaskSide::serve(DateTime now)
{
    points_ = 0;
    while (!waiting_.empty() && advance(waiting_.front())) {
        finish(now);
    }
}

bool LabelTaskSide::advance(LabelJob& job)
{
    if (!exchange_->listener.is_current(job.listener)) {
        return true;
    }
    if (const auto fault = exchange_->fault.load(std::memory_order_relaxed);
        fault != LabelStatus::Done) {
        job.verdict = fault;
    } else if (job.generation != generation_) {
        job.verdict = LabelStatus::Mismatch;
    }
    switch (job.request->kind) {
    case LabelRequest::Kind::Resolve:
        break;
    case LabelRequest::Kind::Sample:
        job.ended_sampler = std::move(sampler_);
        if (job.verdict == LabelStatus::Done) {
            sampler_ = std::move(job.sampler);
        }
        break;
    case LabelRequest::Kind::Read:
    case LabelRequest::Kind::Write:
        return job.verdict != LabelStatus::Done || access(job);
    }
    return true;
}

bool LabelTaskSide::access(LabelJob& job)
{
    LabelRequest& request = *job.request;
    const std::size_t first = job.next_step;
    for (; job.next_step < job.steps.size(); ++job.next_step) {
        const LabelStep& step = job.steps[job.next_step];
        if (!take_points(step.points)) {
            break;
        }
        std::byte* const bytes = request.bytes.data() + step.offset;
        if (request.kind == LabelRequest::Kind::Read) {
            load_label(step.kind, step.memory, bytes);
        } else {
            store_label(step.kind, step.memory, bytes);
        }
    }
    const bool is_done = job.next_step == job.steps.size();
    request.scans += job.next_step > first || is_done ? 1 : 0;
    return is_done;
}

bool LabelTaskSide::take_points(std::uint32_t points)
{
    // A value larger than the unit gets a scan of its own.
    if (access_unit_ != 0 && points_ != 0 && points_ + points > access_unit_) {
        return false;
    }
    points_ += points;
    return true;
}

void LabelTaskSide::finish(DateTime now)
{
    auto job = waiting_.pop();
    if (!job->paused.empty()) {
        job->sampler->resume(job->paused);
    }
    exchange_->waiting.fetch_sub(1, std::memory_order_relaxed);
    job->request->status = job->verdict;
    job->request->time = now;
    exchange_->listener.done(job->request, job->listener);
    exchange_->to_server.give(std::move(job));
}

} // namespace busbar::controller::detail
