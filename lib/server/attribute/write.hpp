#pragma once

#include <optional>
#include <string>
#include <vector>

#include <busbar/types/attribute.hpp>

#include "attribute_needs.hpp"
#include "server/session/service.hpp"
#include "write_job.hpp"

namespace busbar::server::detail {

/// Write (Part 4, 5.11.4).
class WriteOperation final : public OperationOf<WriteRequest>, private SourceCallOwner {
public:
    explicit WriteOperation(const AttributeNeeds& needs) : needs_{needs} {}
    ~WriteOperation() override;

    void start(ServiceContext& context) override;
    [[nodiscard]] bool wants_turn() const override { return !is_finished() && is_planning_; }
    void take_turn(ServiceContext& context) override;
    [[nodiscard]] TimePoint next_deadline() const override;
    void handle_deadline(TimePoint now) override;
    /// None, since sources may still use the message.
    [[nodiscard]] std::vector<std::byte> spare_message() override { return {}; }

private:
    void call_completed() override;
    void ends_with(StatusCode status) override;
    [[nodiscard]] bool takes_aliases() const override { return !needs_.observer.wants_node_ids(); }
    /// Checks values; true if none is left.
    [[nodiscard]] bool plan(ServiceContext& context);

    const AttributeNeeds& needs_;
    std::optional<WriteJob> job_;
    RequestMark mark_;
    bool is_planning_{true};
    bool is_observed_{false};
    unsigned restarts_{0};
};

} // namespace busbar::server::detail
