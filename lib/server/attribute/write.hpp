#pragma once

#include <optional>

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
    [[nodiscard]] TimePoint next_deadline() const override;
    void handle_deadline(TimePoint now) override;

private:
    void call_completed() override;

    const AttributeNeeds& needs_;
    std::optional<WriteJob> job_;
};

} // namespace busbar::server::detail
