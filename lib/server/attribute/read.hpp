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
    [[nodiscard]] TimePoint next_deadline() const override;
    void handle_deadline(TimePoint now) override;

private:
    void call_completed() override;

    const AttributeNeeds& needs_;
    std::optional<ReadJob> job_;
};

} // namespace busbar::server::detail
