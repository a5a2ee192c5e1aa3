#pragma once

#include <optional>
#include <string>
#include <vector>

#include <busbar/types/method.hpp>

#include "call_job.hpp"
#include "server/session/service.hpp"

namespace busbar::server::detail {

/// Call (Part 4, 5.12.2).
class CallOperation final : public OperationOf<CallRequest>, private SourceCallOwner {
public:
    explicit CallOperation(const MethodNeeds& needs) : needs_{needs} {}
    ~CallOperation() override;

    void start(ServiceContext& context) override;
    [[nodiscard]] TimePoint next_deadline() const override;
    void handle_deadline(TimePoint now) override;
    /// None, since sources may still use the message.
    [[nodiscard]] std::vector<std::byte> spare_message() override { return {}; }

private:
    void call_completed() override;
    void ends_with(StatusCode status) override;

    const MethodNeeds& needs_;
    std::optional<CallJob> job_;
    RequestMark mark_;
};

} // namespace busbar::server::detail
