#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <unordered_map>

#include <busbar/backend/label_backend.hpp>
#include <busbar/core/detail/hand_over.hpp>

#include "mapped_sampling.hpp"

namespace busbar::controller::detail {

/// Receives answers from a PLC's thread for the server's. Any thread may call the listener's
/// functions; the others belong to the server's thread.
class LabelInbox final : public backend::LabelListener {
public:
    LabelInbox() = default;
    ~LabelInbox() override;

    void done(std::unique_ptr<backend::LabelRequest> request) override;
    void labels_changed() override;

    /// Returns the oldest answer; null if there is none.
    [[nodiscard]] std::unique_ptr<backend::LabelRequest> take();
    /// True if the labels changed since the last call.
    [[nodiscard]] bool take_change() { return has_changed_.exchange(false); }
    [[nodiscard]] busbar::detail::WakerSlot& waker() { return waker_; }

private:
    busbar::detail::HandOver<backend::LabelRequest> done_;
    /// Answers that were fetched but not taken yet, oldest first.
    std::unique_ptr<backend::LabelRequest> found_;
    std::atomic<bool> has_changed_{false};
    busbar::detail::WakerSlot waker_;
};

/// Passes requests to the PLC and answers back, and updates the labels in between.
class MappedCore {
public:
    MappedCore(std::shared_ptr<backend::LabelBackend> backend, const MappedOptions& options,
               MappedObserver* observer);
    MappedCore(const MappedCore&) = delete;
    MappedCore& operator=(const MappedCore&) = delete;
    ~MappedCore();

    [[nodiscard]] MappedTable& table() { return table_; }
    [[nodiscard]] const MappedTable& table() const { return table_; }
    [[nodiscard]] const MappedOptions& options() const { return options_; }
    [[nodiscard]] LabelInbox& inbox() { return inbox_; }
    [[nodiscard]] bool is_updating() const { return state_ == State::Updating; }
    [[nodiscard]] TargetStatus target_status() const { return target_status_; }
    void set_space(const model::SpaceReader* space) { context_.space = space; }

    void start();
    void stop();
    void read(server::ReadBatch batch);
    void begin(std::unique_ptr<MappedOperation> operation);
    void monitoring_changed(std::span<const server::Monitoring> changes);
    /// Processes the answers of the PLC.
    void pump();

private:
    enum class State : std::uint8_t {
        Idle,     // not between start() and stop()
        Updating, // labels are being resolved
        Ready,
        Failed, // the labels cannot be used
    };

    void update();
    void resolved(backend::LabelRequest& request);
    void end_update(bool is_well, StatusCode failure);
    void begin_waiting();
    void begin_turn();
    void take_all();
    void take(std::unique_ptr<backend::LabelRequest> request);
    void answered(std::unique_ptr<MappedOperation> operation, const backend::LabelRequest& request);
    void repeat(std::unique_ptr<MappedOperation> operation);
    void use_room();
    void advance(std::unique_ptr<MappedOperation> operation);
    /// Gives the request an id by which its answer is recognized.
    std::uint64_t give_id(backend::LabelRequest& request);
    void change_sampling();
    void sampling_answered(const backend::LabelRequest& request);
    [[nodiscard]] bool keep_last(server::ReadBatch& batch);
    void note_target(const backend::LabelRequest& request);
    void tell(LabelUpdate event);

    std::shared_ptr<backend::LabelBackend> backend_;
    MappedOptions options_;
    MappedTable table_;
    MappedContext context_;
    LabelInbox inbox_;
    MappedSampling sampling_;
    bool has_monitoring_changed_{false};
    State state_{State::Idle};
    TargetStatus target_status_{TargetStatus::Unknown};
    /// Answer to requests in State::Failed.
    StatusCode failure_;
    /// True if another update may succeed.
    bool may_retry_{false};
    /// The last update failed because the PLC could not be asked.
    bool is_unreachable_{false};
    /// The update repeats one that did not reach the PLC; its events are reported only if it ends
    /// differently.
    bool is_retry_{false};
    std::uint64_t generation_{0};
    std::uint64_t last_id_{0};
    /// Ids of the last requests to resolve and to sample.
    std::uint64_t resolve_id_{0};
    std::uint64_t sample_id_{0};
    std::unordered_map<std::uint64_t, std::unique_ptr<MappedOperation>> in_flight_;
    std::deque<std::unique_ptr<MappedOperation>> waiting_;
    /// Operations for the next pump().
    std::deque<std::unique_ptr<MappedOperation>> later_;
    /// Operations that the PLC had no room for, to be repeated once others are answered.
    std::deque<std::unique_ptr<MappedOperation>> crowded_;
};

} // namespace busbar::controller::detail
