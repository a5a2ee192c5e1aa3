#include <algorithm>
#include <array>
#include <charconv>
#include <deque>
#include <map>
#include <set>
#include <utility>

#include <busbar/backend/device_protocols.hpp>
#include <busbar/backend/modbus_address.hpp>
#include <busbar/backend/slmp_end_code.hpp>
#include <busbar/core/status_codes.hpp>

#include "core/ascii_case.hpp"
#include "slmp_line.hpp"

namespace busbar::backend {

namespace {

using busbar::detail::is_same_ignoring_case;

// An area has all of a device but its number: codes are below 100 hexadecimal, and what direct
// memory can be differs in two bits.

constexpr std::uint32_t first_direct = 0xF7;

std::uint32_t area_of(const SlmpDevice& device)
{
    const std::uint32_t direct =
        device.direct_memory == 0 ? 0U : device.direct_memory - first_direct;
    return static_cast<std::uint32_t>(device.extension) << 16U | direct << 8U | device.code;
}

SlmpDevice device_of(const PlanAddress& address)
{
    SlmpDevice device;
    device.code = static_cast<std::uint16_t>(address.area & 0xFFU);
    const std::uint32_t direct = address.area >> 8U & 3U;
    device.direct_memory = static_cast<std::uint8_t>(direct == 0 ? 0U : direct + first_direct);
    device.extension = static_cast<std::uint16_t>(address.area >> 16U);
    device.number = address.offset;
    return device;
}

SlmpUnit unit_of(std::uint32_t area)
{
    const auto* const type = find_slmp_device_type(static_cast<std::uint16_t>(area & 0xFFU));
    return type != nullptr ? type->unit : SlmpUnit::Word;
}

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

/// Whether the last part of ":int32:CDAB" is an order.
bool ends_with_order(std::string_view text)
{
    constexpr std::array<std::string_view, 6> orders{"ABCD", "CDAB", "BADC", "DCBA", "AB", "BA"};
    const std::string_view last = text.substr(text.rfind(':') + 1);
    return std::ranges::any_of(orders,
                               [&](auto each) { return is_same_ignoring_case(last, each); });
}

constexpr std::string_view any_register = "holding:0";

/// Reads ":int32:CDAB" by the rules of Modbus, from which a PLC's lowest word first differs. `at`
/// is where it begins, for a Problem.
Configured<ModbusValueType> parse_type(std::string_view text, std::size_t at)
{
    auto address = parse_modbus_address(std::string{any_register} + std::string{text});
    if (!address) {
        Problem problem = std::move(address).error();
        constexpr std::string_view column = "column ";
        std::size_t number = 0;
        if (problem.where.starts_with(column)) {
            const char* const begin = problem.where.data() + column.size();
            static_cast<void>(
                std::from_chars(begin, problem.where.data() + problem.where.size(), number));
            problem.where = std::string{column} + std::to_string(number + at - any_register.size());
        }
        return Unexpected{std::move(problem)};
    }
    ModbusValueType type = address->value;
    if (!ends_with_order(text)) {
        const bool is_text = type.type == ModbusType::Text;
        const bool has_words = registers_of(type) > 1;
        type.order = is_text     ? ModbusOrder::BADC
                     : has_words ? ModbusOrder::CDAB
                                 : ModbusOrder::ABCD;
    }
    return type;
}

Configured<DevicePoint> refused(std::size_t column, const std::string& text)
{
    return Unexpected{Problem{.where = "column " + std::to_string(column), .text = text}};
}

} // namespace

Configured<DevicePoint> parse_slmp_point(std::string_view text, const SlmpProtocolOptions& options)
{
    const std::size_t end = std::min(text.find(':'), text.size());
    const auto address = parse_slmp_address(text.substr(0, end), options.notation);
    if (!address) {
        return Unexpected{address.error()};
    }
    const SlmpUnit unit = unit_of(address->device.code);
    DevicePoint point;
    point.address.area = area_of(address->device);
    point.address.offset = address->device.number;
    if (unit == SlmpUnit::LongTimer) {
        return refused(1,
                       "found a long timer, expected its contact (LTS) or coil (LTC): four words "
                       "of three values are not read");
    }
    if (unit == SlmpUnit::Bit || address->bit) {
        point.type.type = ModbusType::Bool;
        point.bit = address->bit;
        point.is_writable = !address->bit;
        return end == text.size() ? Configured<DevicePoint>{point}
                                  : refused(end + 1, "found \"" + std::string{text.substr(end)} +
                                                         "\", expected nothing: it is a bit");
    }
    if (unit == SlmpUnit::DoubleWord) {
        point.type = {ModbusType::Int32, ModbusOrder::CDAB};
    }
    if (end != text.size()) {
        auto type = parse_type(text.substr(end), end);
        if (!type) {
            return Unexpected{std::move(type).error()};
        }
        point.type = *type;
    }
    const auto words = static_cast<std::uint32_t>(registers_of(point.type));
    if (unit == SlmpUnit::DoubleWord && words != 2) {
        return refused(end + 1, "found a type of " + std::to_string(words) +
                                    " words, expected one of two: int32, uint32, float or bcd32");
    }
    if (point.type.type == ModbusType::Bool) {
        return refused(end + 1, "found bool for a word, expected a bit of it, such as D10.3");
    }
    point.address.width = unit == SlmpUnit::DoubleWord ? 1 : words;
    point.is_writable = true;
    return point;
}

std::unique_ptr<DeviceProtocol> make_slmp_protocol(const SlmpProtocolOptions& options,
                                                   std::span<const DevicePoint> points)
{
    return std::make_unique<SlmpProtocol>(options, points);
}

} // namespace busbar::backend
