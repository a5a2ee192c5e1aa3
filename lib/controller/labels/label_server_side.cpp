#include "label_server_side.hpp"

#include <utility>

namespace busbar::controller::detail {

namespace {

using backend::LabelRequest;
using backend::LabelStatus;

/// The unit in which points of Sample are counted (SH-082679, 8.3, error 1941H).
constexpr std::uint64_t sampling_unit = 8'192;

std::uint64_t sampled_points(std::span<const LabelStep> steps)
{
    std::uint64_t points = 0;
    for (const LabelStep& step : steps) {
        points += step.points;
    }
    return (points + sampling_unit - 1) / sampling_unit * sampling_unit;
}

} // namespace

LabelServerSide::LabelServerSide(LabelExchange& exchange, const SimulatedLabelsOptions& options)
    : exchange_{&exchange}, options_{options}
{
}

void LabelServerSide::start(std::unique_ptr<LabelRequest> request)
{
    static_cast<void>(exchange_->to_server.take_all());
    auto job = std::make_unique<LabelJob>();
    job->request = std::move(request);
    job->request->scans = 0;
    job->listener = exchange_->listener.number();
    if (job->request->kind == LabelRequest::Kind::Sample) {
        sampler_ = nullptr;
    }
    // The PLC's thread only makes it smaller.
    if (exchange_->waiting.load(std::memory_order_relaxed) >= options_.max_waiting) {
        answer(*job, LabelStatus::TooManyOperations);
        return;
    }
    follow_program();
    prepare(*job);
    exchange_->waiting.fetch_add(1, std::memory_order_relaxed);
    if (!give(job)) {
        exchange_->waiting.fetch_sub(1, std::memory_order_relaxed);
        answer(*job, LabelStatus::NoCommunication);
    }
}

void LabelServerSide::attach(backend::LabelListener* listener)
{
    static_cast<void>(exchange_->to_server.take_all());
    exchange_->listener.set(listener);
    sampler_ = nullptr;
    // End the sampling of the previous listener.
    exchange_->to_plc.give(std::make_unique<LabelJob>());
}

std::uint64_t LabelServerSide::sampled(std::span<std::byte> bytes, DateTime& time)
{
    return sampler_ != nullptr ? sampler_->newest(bytes, time) : 0;
}

void LabelServerSide::follow_program()
{
    const std::lock_guard lock{exchange_->mutex};
    if (table_ == nullptr || table_->generation() != exchange_->generation) {
        table_ = std::make_unique<LabelTable>(exchange_->program, exchange_->generation);
    }
}

void LabelServerSide::prepare(LabelJob& job)
{
    job.generation = table_->generation();
    LabelRequest& request = *job.request;
    switch (request.kind) {
    case LabelRequest::Kind::Resolve:
        request.labels.clear();
        for (const std::string& name : request.names) {
            request.labels.push_back(table_->resolve(name));
        }
        break;
    case LabelRequest::Kind::Read:
    case LabelRequest::Kind::Write:
        prepare_access(job);
        break;
    case LabelRequest::Kind::Sample:
        prepare_sample(job);
        break;
    }
}

void LabelServerSide::prepare_access(LabelJob& job)
{
    auto steps = table_->steps(job.request->places, job.request->bytes.size());
    if (!steps) {
        job.verdict = LabelStatus::Mismatch;
        return;
    }
    job.steps = std::move(*steps);
    if (job.request->kind == LabelRequest::Kind::Write && sampler_ != nullptr) {
        job.sampler = sampler_;
        for (const LabelStep& step : job.steps) {
            sampler_->find(step.memory, job.paused);
        }
    }
}

void LabelServerSide::prepare_sample(LabelJob& job)
{
    const LabelRequest& request = *job.request;
    auto steps = table_->steps(request.places, request.bytes.size());
    job.verdict = steps ? sample_refusal(request, *steps) : LabelStatus::Mismatch;
    if (job.verdict == LabelStatus::Done && !request.places.empty()) {
        sampler_ = std::make_shared<LabelSampler>(std::move(*steps), request.bytes.size());
        job.sampler = sampler_;
    }
}

LabelStatus LabelServerSide::sample_refusal(const LabelRequest& request,
                                            std::span<const LabelStep> steps) const
{
    if (steps.empty()) {
        return LabelStatus::Done;
    }
    if (!options_.can_sample) {
        return LabelStatus::SamplingUnknown;
    }
    if (table_->has_unsampled(request.places)) {
        return LabelStatus::UnsampledDevice;
    }
    return sampled_points(steps) > options_.max_sampled_points ? LabelStatus::TooManyPoints
                                                               : LabelStatus::Done;
}

bool LabelServerSide::give(std::unique_ptr<LabelJob>& job)
{
    const std::lock_guard lock{exchange_->mutex};
    if (exchange_->is_halted.load(std::memory_order_relaxed)) {
        return false;
    }
    exchange_->to_plc.give(std::move(job));
    return true;
}

void LabelServerSide::answer(LabelJob& job, LabelStatus status)
{
    job.request->status = status;
    exchange_->listener.done(job.request, job.listener);
}

} // namespace busbar::controller::detail
