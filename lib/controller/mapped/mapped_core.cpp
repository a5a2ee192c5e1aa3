#include "mapped_core.hpp"

#include <algorithm>
#include <utility>

namespace busbar::controller::detail {

using backend::LabelRequest;
using backend::LabelStatus;

namespace {

/// Translates the status of a request that the PLC did not carry out.
StatusCode to_status(LabelStatus status)
{
    switch (status) {
    case LabelStatus::Shutdown:
        return status::Bad_Shutdown;
    case LabelStatus::TooManyOperations:
        return status::Bad_TooManyOperations;
    default:
        return status::Bad_NoCommunication;
    }
}

/// Frees one request after the other: freeing a chain by its head would recurse.
void free_chain(std::unique_ptr<LabelRequest> first)
{
    while (first != nullptr) {
        first = std::move(first->next);
    }
}

} // namespace

MappedCore::MappedCore(std::shared_ptr<backend::LabelBackend> backend, const MappedOptions& options,
                       MappedObserver* observer)
    : backend_{std::move(backend)}, options_{options}, context_{table_, options_, observer, nullptr}
{
}

MappedCore::~MappedCore()
{
    stop();
}

void MappedCore::stop()
{
    if (state_ == State::Idle) {
        return;
    }
    backend_->attach(nullptr);
    while (inbox_.take() != nullptr) {
        // Discard the answers: the operations that waited for them fail below.
    }
    state_ = State::Idle;
    target_status_ = TargetStatus::Unknown;
    sampling_.stop();
    for (auto& [id, operation] : std::exchange(in_flight_, {})) {
        operation->fail(context_, status::Bad_NoCommunication);
    }
    for (auto& operation : std::exchange(waiting_, {})) {
        operation->fail(context_, status::Bad_NoCommunication);
    }
    for (auto* const those : {&crowded_, &later_}) {
        for (auto& operation : std::exchange(*those, {})) {
            operation->fail(context_, status::Bad_NoCommunication);
        }
    }
}

void MappedCore::start()
{
    if (state_ == State::Idle) {
        backend_->attach(&inbox_);
    }
    if (table_.leaves().empty()) {
        state_ = State::Ready; // without events (8.3)
        return;
    }
    is_retry_ = false;
    if (state_ != State::Updating) {
        update();
    }
    pump();
}

void MappedCore::tell(LabelUpdate event)
{
    if (context_.observer != nullptr) {
        context_.observer->label_update(event);
    }
}

std::uint64_t MappedCore::give_id(LabelRequest& request)
{
    request.id = ++last_id_;
    return request.id;
}

void MappedCore::update()
{
    static_cast<void>(inbox_.take_change());
    state_ = State::Updating;
    sampling_.stop();
    if (!is_retry_) {
        tell(LabelUpdate::Started);
    }
    auto request = std::make_unique<LabelRequest>();
    request->kind = LabelRequest::Kind::Resolve;
    request->names = table_.names();
    resolve_id_ = give_id(*request);
    backend_->start(std::move(request));
}

void MappedCore::resolved(LabelRequest& request)
{
    if (request.status == LabelStatus::Mismatch) { // changed again in the meantime
        return update();
    }
    if (request.status != LabelStatus::Done) {
        may_retry_ = true;
        is_unreachable_ = true;
        return end_update(false, to_status(request.status));
    }
    may_retry_ = false;
    is_unreachable_ = false;
    end_update(table_.resolve(request.labels, options_, context_.observer),
               status::Bad_NoCommunication);
}

void MappedCore::end_update(bool is_well, StatusCode failure)
{
    state_ = is_well ? State::Ready : State::Failed;
    failure_ = failure;
    ++generation_;
    if (is_retry_ && !is_unreachable_) {
        tell(LabelUpdate::Started);
    }
    if (is_well) {
        tell(LabelUpdate::Finished);
        change_sampling();
    } else if (!is_retry_ || !is_unreachable_) {
        tell(LabelUpdate::Failed);
    }
    is_retry_ = false;
    begin_waiting();
}

/// Starts the requests that wait now; one that must wait again waits for the next update.
void MappedCore::begin_waiting()
{
    std::deque<std::unique_ptr<MappedOperation>> waiting = std::exchange(waiting_, {});
    for (auto& operation : waiting) {
        if (state_ == State::Failed) {
            operation->fail(context_, failure_);
        } else {
            begin(std::move(operation));
        }
    }
}

void MappedCore::begin(std::unique_ptr<MappedOperation> operation)
{
    if (state_ == State::Failed && may_retry_) {
        waiting_.push_back(std::move(operation));
        is_retry_ = is_unreachable_;
        return update();
    }
    switch (state_) {
    case State::Updating:
        waiting_.push_back(std::move(operation));
        break;
    case State::Ready:
        advance(std::move(operation));
        break;
    case State::Idle:
        operation->fail(context_, status::Bad_NoCommunication);
        break;
    case State::Failed:
        operation->fail(context_, failure_);
        break;
    }
}

void MappedCore::advance(std::unique_ptr<MappedOperation> operation)
{
    auto request = operation->next(context_);
    if (request == nullptr) {
        return;
    }
    operation->note(*request, generation_);
    in_flight_.emplace(give_id(*request), std::move(operation));
    backend_->start(std::move(request));
}

void MappedCore::take(std::unique_ptr<LabelRequest> request)
{
    note_target(*request);
    if (request->id == resolve_id_) {
        if (state_ == State::Updating) {
            resolved(*request);
        }
        return;
    }
    if (request->id == sample_id_) {
        return sampling_answered(*request);
    }
    const auto found = in_flight_.find(request->id);
    if (found != in_flight_.end()) {
        auto operation = std::move(found->second);
        in_flight_.erase(found);
        const bool is_refused = request->status == LabelStatus::TooManyOperations;
        if (is_refused && operation->waits_for_room && !in_flight_.empty()) {
            crowded_.push_back(std::move(operation));
            return;
        }
        answered(std::move(operation), *request);
        use_room();
    }
}

void MappedCore::answered(std::unique_ptr<MappedOperation> operation, const LabelRequest& request)
{
    if (request.status == LabelStatus::Mismatch) {
        return repeat(std::move(operation));
    }
    if (request.status != LabelStatus::Done) {
        return operation->fail(context_, to_status(request.status));
    }
    if (operation->generation != generation_ || !operation->fits(request)) {
        return repeat(std::move(operation)); // the table no longer has what was requested
    }
    operation->done(context_, request);
    if (std::exchange(operation->waits_a_turn, false)) {
        later_.push_back(std::move(operation));
        inbox_.waker().wake();
        return;
    }
    begin(std::move(operation));
}

void MappedCore::begin_turn()
{
    for (auto& operation : std::exchange(later_, {})) {
        begin(std::move(operation));
    }
}

/// Starts one of the operations that waited for room, after another was answered.
void MappedCore::use_room()
{
    if (!crowded_.empty()) {
        auto operation = std::move(crowded_.front());
        crowded_.pop_front();
        begin(std::move(operation));
    }
}

void MappedCore::repeat(std::unique_ptr<MappedOperation> operation)
{
    if (++operation->repetitions > options_.max_repetitions) {
        return operation->fail(context_, status::Bad_NoCommunication);
    }
    operation->restart(context_);
    if (operation->generation == generation_ && state_ == State::Ready) {
        update();
    }
    begin(std::move(operation));
}

void MappedCore::note_target(const LabelRequest& request)
{
    const bool is_lost =
        request.status == LabelStatus::NoCommunication || request.status == LabelStatus::Shutdown;
    target_status_ = is_lost ? TargetStatus::Failing : TargetStatus::Communicating;
}

void MappedCore::pump()
{
    begin_turn();
    take_all();
    // A change during an update is handled after the update.
    if (state_ == State::Ready && !table_.leaves().empty() && inbox_.take_change()) {
        update();
        take_all();
    } else if (state_ == State::Failed && inbox_.take_change()) {
        may_retry_ = true; // together with the next request (8.3)
        is_unreachable_ = false;
    }
}

void MappedCore::take_all()
{
    while (auto request = inbox_.take()) {
        take(std::move(request));
    }
}

void MappedCore::read(server::ReadBatch batch)
{
    if (state_ == State::Updating && batch.is_sample() && keep_last(batch)) {
        return;
    }
    if (state_ != State::Ready || !MappedSampling::serves(options_.sampling, batch.is_sample())) {
        return begin(make_read(std::move(batch)));
    }
    if (sampling_.state() == MappedSampling::State::Failed) {
        return batch.fail(status::Bad_NoCommunication);
    }
    if (sampling_.state() == MappedSampling::State::Off) {
        change_sampling();
    }
    if (!sampling_.answer(context_, *backend_, batch)) {
        begin(make_read(std::move(batch)));
    }
}

/// Answers with the last values while labels are updated (10.3); false if one has no value yet.
bool MappedCore::keep_last(server::ReadBatch& batch)
{
    for (const server::ReadItem& item : batch.items()) {
        const auto* const variable = table_.variable(item.handle);
        if (variable != nullptr && variable->shape != nullptr && variable->time.is_null()) {
            return false;
        }
    }
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const auto* const variable = table_.variable(batch.items()[i].handle);
        if (variable == nullptr) {
            continue;
        }
        server::ReadSlot& slot = batch.results()[i];
        if (variable->shape == nullptr) {
            slot = DataValue{status::Bad_NotSupported};
        } else {
            slot = DataValue{variable->kept, status::Good_Overload, variable->time};
        }
    }
    batch.complete();
    return true;
}

void MappedCore::monitoring_changed(std::span<const server::Monitoring> changes)
{
    bool has_other = false; // sampling begins or ends; a changed interval makes no difference for
                            // the PLC
    for (const server::Monitoring& change : changes) {
        if (auto* const variable = table_.variable(change.handle)) {
            has_other = has_other || variable->interval.has_value() != change.interval.has_value();
            variable->interval = change.interval;
        }
    }
    if (has_other && options_.sampling == SamplingMode::MonitoredItems && state_ == State::Ready) {
        change_sampling();
    }
}

void MappedCore::change_sampling()
{
    if (options_.sampling == SamplingMode::Standard) {
        return;
    }
    if (sampling_.state() == MappedSampling::State::Changing) {
        has_monitoring_changed_ = true;
        return;
    }
    has_monitoring_changed_ = false;
    if (auto request = sampling_.change(context_)) {
        sample_id_ = give_id(*request);
        backend_->start(std::move(request));
    }
}

void MappedCore::sampling_answered(const LabelRequest& request)
{
    if (sampling_.state() != MappedSampling::State::Changing) {
        return; // the labels were updated in the meantime
    }
    if (request.status == LabelStatus::Mismatch) {
        return update();
    }
    sampling_.changed(context_, request);
    if (has_monitoring_changed_) {
        change_sampling();
    }
}

LabelInbox::~LabelInbox()
{
    free_chain(std::move(found_));
    free_chain(std::unique_ptr<LabelRequest>{done_.take()});
}

void LabelInbox::done(std::unique_ptr<LabelRequest> request)
{
    if (done_.push(*request.release())) {
        waker_.wake();
    }
}

void LabelInbox::labels_changed()
{
    has_changed_ = true;
    waker_.wake();
}

std::unique_ptr<LabelRequest> LabelInbox::take()
{
    if (found_ == nullptr) {
        found_.reset(done_.take());
    }
    std::unique_ptr<LabelRequest> oldest = std::move(found_);
    if (oldest != nullptr) {
        found_ = std::move(oldest->next);
    }
    return oldest;
}

} // namespace busbar::controller::detail
