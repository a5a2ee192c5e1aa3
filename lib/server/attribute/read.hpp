#pragma once

#include <optional>

#include <busbar/types/attribute.hpp>

#include "attribute_needs.hpp"
#include "read_job.hpp"
#include "server/session/service.hpp"

namespace busbar::server::detail {

/// Read (Part 4, 5.11.2).
class ReadOperation final : public OperationOf<ReadRequest>, private SourceCallOwner {
public:
    explicit ReadOperation(const AttributeNeeds& needs) : needs_{needs} {}

    void start(ServiceContext& context) override;
    [[nodiscard]] bool wants_turn() const override { return !is_finished() && is_planning_; }
    void take_turn(ServiceContext& context) override;
    [[nodiscard]] TimePoint next_deadline() const override;
    void handle_deadline(TimePoint now) override;

private:
    void call_completed() override;
    [[nodiscard]] bool takes_aliases() const override { return true; }
    /// Looks nodes up; true if none is left.
    [[nodiscard]] bool plan(ServiceContext& context);
    /// Charges the session for memory that is held while waiting; false if it cannot pay.
    [[nodiscard]] bool pay();

    const AttributeNeeds& needs_;
    std::optional<ReadJob> job_;
    bool is_planning_{true};
    unsigned restarts_{0};
    std::size_t paid_{0};
};

} // namespace busbar::server::detail
