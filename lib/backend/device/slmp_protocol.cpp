#include <deque>
#include <map>
#include <set>
#include <utility>

#include <busbar/backend/device_protocols.hpp>
#include <busbar/backend/slmp_end_code.hpp>
#include <busbar/core/status_codes.hpp>

#include "slmp_area.hpp"
#include "slmp_line.hpp"

namespace busbar::backend {

namespace {

using detail::device_of;
using detail::unit_of;

/// Sends the requests of a plan.
class SlmpPlanLine final : public detail::SlmpLine {
public:
    using SlmpLine::SlmpLine;

    Result<void> send(const PlanRequest& request, TimePoint now) override;
    [[nodiscard]] std::optional<DeviceAnswer> next_answer() override;

private:
    void answered(SlmpEvent event) override;
    [[nodiscard]] bool repeats(const SlmpEvent& event, const PlanRequest& request);

    /// A request was served in the present form.
    bool is_form_known_{false};
    /// The requests without an answer, by the client's id.
    std::map<std::uint64_t, PlanRequest> requests_;
    std::deque<DeviceAnswer> answers_;
};

Result<void> SlmpPlanLine::send(const PlanRequest& request, TimePoint now)
{
    if (request.mask != 0xFFFF) {
        return fail(status::Bad_NotWritable);
    }
    const PlanAddress& range = request.ranges.front();
    SlmpOperation operation;
    operation.command = request.is_write ? SlmpCommand::BatchWrite : SlmpCommand::BatchRead;
    operation.is_bits = unit_of(range.area) == SlmpUnit::Bit;
    operation.has_long_form = findings().has_long_form;
    const std::uint32_t each = unit_of(range.area) == SlmpUnit::DoubleWord ? 2 : 1;
    operation.blocks.push_back({device_of(range), static_cast<std::uint16_t>(range.width * each)});
    operation.words = request.words;
    const auto sent = ask(std::move(operation), now);
    if (!sent) {
        return fail(sent.error());
    }
    requests_.emplace(*sent, request);
    return {};
}

/// Q and L refuse the long form of requests as a command that they do not know, and have answers in
/// the short one.
bool SlmpPlanLine::repeats(const SlmpEvent& event, const PlanRequest& request)
{
    if (event.status.is_bad() || is_form_known_) {
        return false;
    }
    const SlmpFault fault = slmp_end_code(event.answer.end_code).fault;
    if (findings().has_long_form && fault == SlmpFault::Request) {
        findings().has_long_form = false;
        return send(request, now()).has_value();
    }
    is_form_known_ = fault == SlmpFault::None;
    return false;
}

DeviceAnswer answer_of(SlmpEvent& event, std::uint64_t request)
{
    DeviceAnswer answer;
    answer.request = request;
    answer.round_trip = event.round_trip;
    answer.status = event.status;
    if (event.status.is_bad()) {
        return answer;
    }
    const SlmpEndCode code = slmp_end_code(event.answer.end_code);
    if (code.fault == SlmpFault::None) {
        answer.kind = DeviceAnswer::Kind::Done;
        answer.words = std::move(event.answer.words);
        return answer;
    }
    answer.status = code.status;
    const bool is_in_it = code.fault == SlmpFault::Address || code.fault == SlmpFault::Size;
    answer.kind = is_in_it ? DeviceAnswer::Kind::Refused : DeviceAnswer::Kind::Failed;
    return answer;
}

void SlmpPlanLine::answered(SlmpEvent event)
{
    const auto found = requests_.extract(event.id);
    if (!found.empty() && !repeats(event, found.mapped())) {
        answers_.push_back(answer_of(event, found.mapped().id));
    }
}

std::optional<DeviceAnswer> SlmpPlanLine::next_answer()
{
    look();
    if (answers_.empty()) {
        return std::nullopt;
    }
    DeviceAnswer first = std::move(answers_.front());
    answers_.pop_front();
    return first;
}

class SlmpProtocol final : public DeviceProtocol {
public:
    SlmpProtocol(const SlmpProtocolOptions& options, std::span<const DevicePoint> points)
        : options_{options}, findings_{options.client.frame, options.finds_frame,
                                       options.notation.has_long_form}
    {
        for (const DevicePoint& point : points) {
            areas_.insert(point.address.area);
        }
    }

    [[nodiscard]] PlanConfig plan() const override
    {
        PlanConfig config;
        config.max_under_way = options_.client.max_under_way;
        for (const std::uint32_t area : areas_) {
            const SlmpUnit unit = unit_of(area);
            const bool is_bits = unit == SlmpUnit::Bit;
            PlanRule rule;
            rule.area = area;
            rule.words_per_unit = unit == SlmpUnit::DoubleWord ? 2 : 1;
            rule.max_read = is_bits ? options_.max_bits : options_.max_words / rule.words_per_unit;
            rule.max_write = rule.max_read;
            rule.max_gap = is_bits ? options_.max_gap * 16U : options_.max_gap;
            config.rules.push_back(rule);
        }
        return config;
    }
    [[nodiscard]] std::unique_ptr<DeviceLine> connect(TimePoint now) override
    {
        SlmpClientOptions client = options_.client;
        client.frame = findings_.frame;
        return std::make_unique<SlmpPlanLine>(client, findings_, now);
    }

private:
    SlmpProtocolOptions options_;
    std::set<std::uint32_t> areas_;
    detail::SlmpFindings findings_;
};

} // namespace

std::unique_ptr<DeviceProtocol> make_slmp_protocol(const SlmpProtocolOptions& options,
                                                   std::span<const DevicePoint> points)
{
    return std::make_unique<SlmpProtocol>(options, points);
}

} // namespace busbar::backend
