#pragma once

#include <deque>
#include <unordered_map>

#include "label_inbox.hpp"
#include "mapped_sampling.hpp"

namespace busbar::controller::detail {

/// Requests on their way to the PLC and back, and updates of labels between them.
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
    /// Takes in what the PLC has answered.
    void pump();

private:
    enum class State : std::uint8_t {
        Idle,     // not between start() and stop()
        Updating, // labels are being resolved
        Ready,
        Failed, // they cannot be used
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
    /// By which the answer will be known.
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
    /// Of State::Failed.
    StatusCode failure_;
    /// Another update may find the labels well.
    bool may_retry_{false};
    /// The last update failed because the PLC could not be asked.
    bool is_unreachable_{false};
    /// The update tries that again: its events are told only if it ends otherwise.
    bool is_retry_{false};
    std::uint64_t generation_{0};
    std::uint64_t last_id_{0};
    /// What the PLC was asked to resolve and to sample.
    std::uint64_t resolve_id_{0};
    std::uint64_t sample_id_{0};
    std::unordered_map<std::uint64_t, std::unique_ptr<MappedOperation>> in_flight_;
    std::deque<std::unique_ptr<MappedOperation>> waiting_;
    /// Those that wait for the next pump().
    std::deque<std::unique_ptr<MappedOperation>> later_;
    /// Those that the PLC had no room for, while others are in flight.
    std::deque<std::unique_ptr<MappedOperation>> crowded_;
};

} // namespace busbar::controller::detail
