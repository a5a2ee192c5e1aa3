#include <algorithm>
#include <deque>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <busbar/backend/device_protocols.hpp>
#include <busbar/backend/modbus_address.hpp>
#include <busbar/core/status_codes.hpp>

namespace busbar::backend {

namespace {

/// The area of a table of a unit.
std::uint32_t area_of(ModbusTable table, std::uint8_t unit)
{
    return static_cast<std::uint32_t>(unit) << 2U | static_cast<std::uint32_t>(table);
}

ModbusTable table_of(std::uint32_t area)
{
    return static_cast<ModbusTable>(area & 3U);
}

ModbusFunction reading_of(ModbusTable table)
{
    switch (table) {
    case ModbusTable::Coil:
        return ModbusFunction::ReadCoils;
    case ModbusTable::DiscreteInput:
        return ModbusFunction::ReadDiscreteInputs;
    case ModbusTable::InputRegister:
        return ModbusFunction::ReadInputRegisters;
    case ModbusTable::HoldingRegister:
        break;
    }
    return ModbusFunction::ReadHoldingRegisters;
}

ModbusRequest writing_of(const PlanRequest& request)
{
    const PlanAddress& range = request.ranges.front();
    ModbusRequest made;
    made.address = static_cast<std::uint16_t>(range.offset);
    made.quantity = static_cast<std::uint16_t>(range.width);
    if (request.mask != 0xFFFF) {
        made.function = ModbusFunction::MaskWriteRegister;
        made.and_mask = static_cast<std::uint16_t>(~request.mask);
        made.or_mask = request.words.front();
        return made;
    }
    made.values = request.words;
    const bool is_one = range.width == 1;
    if (table_of(range.area) == ModbusTable::Coil) {
        made.function = is_one ? ModbusFunction::WriteCoil : ModbusFunction::WriteCoils;
    } else {
        made.function = is_one ? ModbusFunction::WriteRegister : ModbusFunction::WriteRegisters;
    }
    return made;
}

ModbusRequest request_of(const PlanRequest& request)
{
    if (request.is_write) {
        return writing_of(request);
    }
    const PlanAddress& range = request.ranges.front();
    ModbusRequest made;
    made.function = reading_of(table_of(range.area));
    made.address = static_cast<std::uint16_t>(range.offset);
    made.quantity = static_cast<std::uint16_t>(range.width);
    return made;
}

/// Function 23, which writes and reads registers in one request, is not used: many devices do not
/// have it, and an exception does not say which of the two was refused, while a write is sent once.
class ModbusLine final : public DeviceLine {
public:
    /// `may_ask` says whether to ask for the identification, and must outlive the object.
    ModbusLine(const ModbusProtocolOptions& options, bool& may_ask, TimePoint now);
    ModbusLine(const ModbusLine&) = delete;
    ModbusLine& operator=(const ModbusLine&) = delete;
    ~ModbusLine() override
    {
        // It closed the connection instead of answering.
        may_ask_ = may_ask_ && !asked_;
    }

    [[nodiscard]] bool is_ready() const override { return !asked_; }
    [[nodiscard]] bool has_answered() const override { return client_.counters().answers > 0; }
    Result<void> send(const PlanRequest& request, TimePoint now) override
    {
        const auto unit = static_cast<std::uint8_t>(request.ranges.front().area >> 2U);
        const auto sent = client_.send(request_of(request), unit, now);
        if (!sent) {
            return fail(sent.error());
        }
        requests_.emplace(*sent, request.id);
        return {};
    }
    [[nodiscard]] std::optional<DeviceAnswer> next_answer() override;
    Result<void> feed(std::span<const std::byte> in, TimePoint now) override
    {
        auto fed = client_.feed(in, now);
        look();
        return fed;
    }
    [[nodiscard]] std::span<const std::byte> output() const override { return client_.output(); }
    void consume(std::size_t size) override { client_.consume(size); }
    [[nodiscard]] TimePoint next_deadline() const override { return client_.next_deadline(); }
    void handle_deadline(TimePoint now) override
    {
        client_.handle_deadline(now);
        look();
    }
    [[nodiscard]] bool is_closed() const override { return client_.is_closed(); }
    [[nodiscard]] std::string reason() const override { return reason_; }
    [[nodiscard]] DeviceIdentity identity() const override { return identity_; }

private:
    /// Takes what has come from the client.
    void look();
    void take_identity(const ModbusEvent& event);
    [[nodiscard]] static DeviceAnswer answer_of(ModbusEvent& event, std::uint64_t request);

    ModbusClient client_;
    bool& may_ask_;
    /// The request for the identification, as long as it has no answer.
    std::optional<std::uint64_t> asked_;
    DeviceIdentity identity_;
    std::deque<DeviceAnswer> answers_;
    /// The plan's number of a request by the client's.
    std::map<std::uint64_t, std::uint64_t> requests_;
    std::string reason_;
};

ModbusLine::ModbusLine(const ModbusProtocolOptions& options, bool& may_ask, TimePoint now)
    : client_{options.client}, may_ask_{may_ask}
{
    if (may_ask) {
        ModbusRequest request;
        request.function = ModbusFunction::ReadDeviceIdentification;
        // A broadcast has no answer.
        if (const auto sent = client_.send(request, options.unit, now)) {
            asked_ = *sent;
        }
    }
}

void ModbusLine::take_identity(const ModbusEvent& event)
{
    asked_.reset();
    may_ask_ = event.status != StatusCode{status::Bad_Timeout};
    for (const auto& object : event.answer.identification.objects) {
        std::string* const parts[] = {&identity_.vendor, &identity_.product, &identity_.revision};
        if (object.id < std::size(parts)) {
            *parts[object.id] = object.value;
        }
    }
}

DeviceAnswer ModbusLine::answer_of(ModbusEvent& event, std::uint64_t request)
{
    DeviceAnswer answer;
    answer.request = request;
    answer.status = event.status;
    answer.round_trip = event.round_trip;
    const auto& exception = event.answer.exception;
    if (!event.status.is_bad()) {
        answer.kind = DeviceAnswer::Kind::Done;
        answer.words = std::move(event.answer.values);
    } else if (exception) {
        answer.code = static_cast<std::uint16_t>(*exception);
        answer.kind =
            is_refusal(*exception) ? DeviceAnswer::Kind::Refused : DeviceAnswer::Kind::Failed;
    }
    return answer;
}

void ModbusLine::look()
{
    while (auto event = client_.next_event()) {
        if (event->kind == ModbusEvent::Kind::Closed) {
            reason_ = std::move(event->reason);
            continue;
        }
        if (event->id == asked_) {
            take_identity(*event);
        } else if (const auto request = requests_.extract(event->id); !request.empty()) {
            answers_.push_back(answer_of(*event, request.mapped()));
        }
    }
}

std::optional<DeviceAnswer> ModbusLine::next_answer()
{
    look();
    if (answers_.empty()) {
        return std::nullopt;
    }
    DeviceAnswer first = std::move(answers_.front());
    answers_.pop_front();
    return first;
}

class ModbusProtocol final : public DeviceProtocol {
public:
    ModbusProtocol(const ModbusProtocolOptions& options, std::span<const DevicePoint> points)
        : options_{options}, may_ask_{options.asks_identity}
    {
        for (const DevicePoint& point : points) {
            areas_.insert(point.address.area);
        }
    }

    [[nodiscard]] PlanConfig plan() const override
    {
        PlanConfig config;
        config.max_under_way = options_.client.is_gateway ? 1 : options_.client.max_under_way;
        for (const std::uint32_t area : areas_) {
            const bool is_bits = has_bits(table_of(area));
            PlanRule rule;
            rule.area = area;
            rule.max_read = is_bits ? max_modbus_read_bits : options_.max_read;
            rule.max_write = is_bits ? max_modbus_write_coils : options_.max_write;
            rule.max_gap = is_bits ? options_.max_gap * 16U : options_.max_gap;
            config.rules.push_back(rule);
        }
        return config;
    }
    [[nodiscard]] std::string text_of(std::uint16_t code) const override
    {
        return busbar::backend::text_of(static_cast<ModbusException>(code));
    }
    [[nodiscard]] std::unique_ptr<DeviceLine> connect(TimePoint now) override
    {
        return std::make_unique<ModbusLine>(options_, may_ask_, now);
    }

private:
    ModbusProtocolOptions options_;
    bool may_ask_;
    std::set<std::uint32_t> areas_;
};

} // namespace

Configured<DevicePoint> parse_modbus_point(std::string_view text,
                                           const ModbusProtocolOptions& options)
{
    return parse_modbus_address(text).transform([&](const ModbusAddress& address) {
        DevicePoint point;
        point.address.area = area_of(address.table, address.unit.value_or(options.unit));
        point.address.offset = address.offset;
        point.address.width = static_cast<std::uint32_t>(registers_of(address.value));
        point.type = address.value;
        point.bit = address.bit;
        point.is_writable = is_writable(address.table);
        return point;
    });
}

std::unique_ptr<DeviceProtocol> make_modbus_protocol(const ModbusProtocolOptions& options,
                                                     std::span<const DevicePoint> points)
{
    return std::make_unique<ModbusProtocol>(options, points);
}

} // namespace busbar::backend
