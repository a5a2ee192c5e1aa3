#include <algorithm>
#include <climits>
#include <deque>
#include <map>
#include <set>
#include <utility>

#include <busbar/backend/device_protocols.hpp>
#include <busbar/backend/slmp_end_code.hpp>
#include <busbar/core/status_codes.hpp>

#include "slmp_line.hpp"
#include "slmp_request.hpp"

namespace busbar::backend {

namespace {

/// Sends the requests of a plan.
class SlmpPlanLine final : public detail::SlmpLine {
public:
    using SlmpLine::SlmpLine;

    Result<void> send(const PlanRequest& request, TimePoint now) override;
    [[nodiscard]] std::optional<DeviceAnswer> next_answer() override;

private:
    struct Sent {
        PlanRequest request;
        SlmpCommand command{SlmpCommand::BatchRead};
        bool has_long_form{false};
        /// It was refused in the long form before.
        bool is_repeated{false};
    };

    void answered(SlmpEvent event) override;
    [[nodiscard]] Result<void> send(const PlanRequest& request, bool is_repeated);
    [[nodiscard]] bool repeats(const SlmpEvent& event, const Sent& sent);
    [[nodiscard]] DeviceAnswer answer_of(SlmpEvent& event, const Sent& sent);

    /// A request was served in the present form.
    bool is_form_known_{false};
    /// The requests without an answer, by the client's id.
    std::map<std::uint64_t, Sent> requests_;
    std::deque<DeviceAnswer> answers_;
};

Result<void> SlmpPlanLine::send(const PlanRequest& request, TimePoint now)
{
    set_now(now);
    return send(request, false);
}

Result<void> SlmpPlanLine::send(const PlanRequest& request, bool is_repeated)
{
    if (request.mask != 0xFFFF) {
        return fail(status::Bad_NotWritable);
    }
    SlmpOperation operation = detail::operation_of(request, findings());
    const SlmpCommand command = operation.command;
    const auto sent = ask(std::move(operation), now());
    if (!sent) {
        return fail(sent.error());
    }
    requests_.emplace(*sent, Sent{request, command, findings().has_long_form, is_repeated});
    return {};
}

/// Q and L refuse the long form of requests as a command that they do not know, and have answers in
/// the short one. What is refused in both forms is another matter than the form.
bool SlmpPlanLine::repeats(const SlmpEvent& event, const Sent& sent)
{
    if (event.status.is_bad() || is_form_known_) {
        return false;
    }
    const SlmpFault fault = slmp_end_code(event.answer.end_code).fault;
    if (fault == SlmpFault::Request && sent.has_long_form) {
        findings().set_long_form(false);
        return send(sent.request, true).has_value();
    }
    if (fault == SlmpFault::Request && sent.is_repeated) {
        findings().set_long_form(true);
    }
    is_form_known_ = fault == SlmpFault::None;
    return false;
}

DeviceAnswer SlmpPlanLine::answer_of(SlmpEvent& event, const Sent& sent)
{
    DeviceAnswer answer;
    answer.request = sent.request.id;
    answer.round_trip = event.round_trip;
    answer.status = event.status;
    if (event.status.is_bad()) {
        return answer;
    }
    const SlmpEndCode code = slmp_end_code(event.answer.end_code);
    if (code.fault == SlmpFault::None) {
        answer.kind = DeviceAnswer::Kind::Done;
        answer.words = detail::words_of(sent.request, sent.command, std::move(event.answer.words));
        return answer;
    }
    answer.code = code.code;
    answer.status = code.status;
    const bool is_in_it = code.fault == SlmpFault::Address || code.fault == SlmpFault::Size;
    if (code.fault == SlmpFault::Request && sent.request.ranges.size() > 1) {
        answer.kind = DeviceAnswer::Kind::Unknown;
        static_cast<void>(findings().lose(sent.command));
    } else {
        answer.kind = is_in_it ? DeviceAnswer::Kind::Refused : DeviceAnswer::Kind::Failed;
    }
    return answer;
}

void SlmpPlanLine::answered(SlmpEvent event)
{
    const auto found = requests_.extract(event.id);
    if (!found.empty() && !repeats(event, found.mapped())) {
        answers_.push_back(answer_of(event, found.mapped()));
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

/// SD203, the CPU's operating status, whose lowest four bits have the mode. The list of special
/// registers of QCPU documents it; other clients read it of iQ-R and FX5, too. A PLC that has it in
/// another place refuses it, or says RUN with its 0.
constexpr SlmpDevice mode_device{.code = 0xA9, .number = 203};

class SlmpProtocol final : public DeviceProtocol {
public:
    SlmpProtocol(const SlmpProtocolOptions& options, std::span<const DevicePoint> points)
        : options_{options}, findings_{detail::findings_of(options)}
    {
        areas_.insert(detail::area_of(mode_device));
        for (const DevicePoint& point : points) {
            areas_.insert(point.address.area);
            findings_.has_io = findings_.has_io || detail::is_io(point.address);
        }
    }

    [[nodiscard]] PlanConfig plan() const override
    {
        const detail::SlmpLimits limits = detail::limits_of(findings_, options_.client.is_datagram);
        PlanConfig config;
        config.max_under_way = std::min(options_.client.max_under_way, limits.under_way);
        for (const std::uint32_t area : areas_) {
            config.rules.push_back(detail::rule_of(area, options_, limits));
        }
        return config;
    }
    [[nodiscard]] std::uint64_t plan_version() const override { return findings_.version; }
    [[nodiscard]] std::string text_of(std::uint16_t code) const override
    {
        return slmp_end_code_text(code);
    }
    [[nodiscard]] std::optional<PlanAddress> mode_place() const override
    {
        return PlanAddress{detail::area_of(mode_device), mode_device.number, 1};
    }
    [[nodiscard]] DeviceMode mode_of(std::span<const std::uint16_t> words) const override
    {
        constexpr unsigned stop = 2;
        constexpr unsigned pause = 3;
        const unsigned mode = words.empty() ? UINT_MAX : words.front() & 0xFU;
        // 1 is the step-by-step run of older CPUs.
        return mode <= 1       ? DeviceMode::Run
               : mode == stop  ? DeviceMode::Stop
               : mode == pause ? DeviceMode::Pause
                               : DeviceMode::Unknown;
    }
    [[nodiscard]] std::unique_ptr<DeviceLine> connect(TimePoint now) override
    {
        return std::make_unique<SlmpPlanLine>(options_, findings_, now);
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
