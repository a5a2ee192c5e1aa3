#include <busbar/backend/modbus_client.hpp>

#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include "frame_buffer.hpp"

namespace busbar::backend {

namespace {

/// A request that waits for its turn or its answer.
struct PendingRequest {
    std::uint64_t id{0};
    ModbusRequest request{};
    std::uint8_t unit{0};
    /// Since it was sent:
    std::uint16_t transaction{0};
    TimePoint sent{};
    TimePoint deadline{no_deadline};
    bool is_broadcast{false};
};

} // namespace

struct ModbusClient::Impl {
    explicit Impl(ModbusClientOptions given) : options{given}
    {
        options.max_under_way =
            options.is_gateway ? 1 : std::max<std::size_t>(options.max_under_way, 1);
    }

    [[nodiscard]] bool is_broadcast(std::uint8_t unit) const
    {
        return options.is_gateway && unit == 0;
    }

    void send_waiting(TimePoint now)
    {
        while (!is_closed && !waiting.empty() && sent.size() < options.max_under_way) {
            PendingRequest next = std::move(waiting.front());
            waiting.pop_front();
            next.transaction = free_transaction();
            next.sent = now;
            next.is_broadcast = is_broadcast(next.unit);
            next.deadline = now + (next.is_broadcast ? options.broadcast_pause : options.timeout);
            std::vector<std::byte> pdu;
            // send() has seen that it can be encoded.
            static_cast<void>(encode_modbus(next.request, pdu));
            encode_modbus(ModbusHeader{next.transaction, next.unit, pdu.size()}, output);
            output.insert(output.end(), pdu.begin(), pdu.end());
            ++counters.requests;
            sent.push_back(std::move(next));
        }
    }

    /// Returns the next number that no request under way has.
    [[nodiscard]] std::uint16_t free_transaction()
    {
        do {
            ++last_transaction;
        } while (std::ranges::find(sent, last_transaction, &PendingRequest::transaction) !=
                 sent.end());
        return last_transaction;
    }

    void take_frame(const ModbusHeader& header, std::span<const std::byte> pdu, TimePoint now)
    {
        const auto at = std::ranges::find(sent, header.transaction, &PendingRequest::transaction);
        if (at == sent.end() || at->is_broadcast) {
            ++counters.unexpected;
            return;
        }
        if (at->unit != header.unit) {
            ++counters.wrong_units;
            return;
        }
        const PendingRequest request = std::move(*at);
        sent.erase(at);
        ModbusEvent event;
        event.id = request.id;
        event.round_trip = now - request.sent;
        auto response = parse_modbus_response(request.request, pdu);
        if (!response) {
            ++counters.malformed;
            event.status = response.error();
        } else {
            ++counters.answers;
            event.answer = std::move(*response);
        }
        if (event.answer.exception) {
            ++counters.exceptions;
            event.status = status_of(*event.answer.exception, request.request.function);
        }
        events.push_back(std::move(event));
    }

    /// Ends what is under way and has waited long enough.
    void expire(TimePoint now)
    {
        for (auto at = sent.begin(); at != sent.end();) {
            if (at->deadline > now) {
                ++at;
                continue;
            }
            ModbusEvent event;
            event.id = at->id;
            event.answer.function = at->request.function;
            if (!at->is_broadcast) {
                event.status = status::Bad_Timeout;
                ++counters.timeouts;
                count_silence(*at, now);
            }
            events.push_back(std::move(event));
            at = sent.erase(at);
        }
    }

    void count_silence(const PendingRequest& request, TimePoint now)
    {
        if (silent == 0 || request.sent >= silent_since) {
            ++silent;
            silent_since = now;
        }
    }

    void close(StatusCode status, std::string reason)
    {
        if (is_closed) {
            return;
        }
        is_closed = true;
        closed_with = status;
        output.clear();
        const auto end = [&](const PendingRequest& request) {
            ModbusEvent event;
            event.id = request.id;
            event.status = status;
            event.answer.function = request.request.function;
            events.push_back(std::move(event));
        };
        std::ranges::for_each(sent, end);
        std::ranges::for_each(waiting, end);
        sent.clear();
        waiting.clear();
        ModbusEvent last;
        last.kind = ModbusEvent::Kind::Closed;
        last.status = status;
        last.reason = std::move(reason);
        events.push_back(std::move(last));
    }

    ModbusClientOptions options;
    ModbusClientCounters counters;
    std::deque<PendingRequest> waiting;
    /// In the order of sending.
    std::vector<PendingRequest> sent;
    std::deque<ModbusEvent> events;
    std::vector<std::byte> output;
    detail::ModbusFrameBuffer input;
    std::uint64_t last_id{0};
    std::uint16_t last_transaction{0};
    /// Timeouts since the last byte of the peer, and the time of the last one that was counted.
    std::size_t silent{0};
    TimePoint silent_since{};
    bool is_closed{false};
    StatusCode closed_with{};
};

ModbusClient::ModbusClient(ModbusClientOptions options) : impl_{std::make_unique<Impl>(options)} {}

ModbusClient::ModbusClient(ModbusClient&&) noexcept = default;
ModbusClient& ModbusClient::operator=(ModbusClient&&) noexcept = default;
ModbusClient::~ModbusClient() = default;

Result<std::uint64_t> ModbusClient::send(ModbusRequest request, std::uint8_t unit, TimePoint now)
{
    if (impl_->is_closed) {
        return fail(status::Bad_ConnectionClosed);
    }
    if (impl_->waiting.size() + impl_->sent.size() >= impl_->options.max_requests) {
        return fail(status::Bad_TooManyOperations);
    }
    std::vector<std::byte> ignored;
    const bool reads =
        !is_write(request.function) || request.function == ModbusFunction::ReadWriteRegisters;
    if ((impl_->is_broadcast(unit) && reads) || !encode_modbus(request, ignored)) {
        return fail(status::Bad_OutOfRange);
    }
    PendingRequest pending;
    pending.id = ++impl_->last_id;
    pending.request = std::move(request);
    pending.unit = unit;
    impl_->waiting.push_back(std::move(pending));
    impl_->send_waiting(now);
    return impl_->last_id;
}

Result<void> ModbusClient::feed(std::span<const std::byte> in, TimePoint now)
{
    impl_->silent = in.empty() ? impl_->silent : 0;
    while (!impl_->is_closed && !in.empty()) {
        in = in.subspan(impl_->input.take(in));
        const auto frame = impl_->input.frame();
        if (!frame) {
            impl_->close(frame.error(), "the peer sent bytes that are not Modbus TCP");
        } else if (*frame) {
            impl_->take_frame((*frame)->header, (*frame)->pdu, now);
            impl_->input.drop_frame();
        }
    }
    impl_->send_waiting(now);
    return impl_->is_closed ? Result<void>{fail(impl_->closed_with)} : Result<void>{};
}

std::optional<ModbusEvent> ModbusClient::next_event()
{
    if (impl_->events.empty()) {
        return std::nullopt;
    }
    std::optional event{std::move(impl_->events.front())};
    impl_->events.pop_front();
    return event;
}

std::span<const std::byte> ModbusClient::output() const
{
    return impl_->output;
}

void ModbusClient::consume(std::size_t size)
{
    const auto count = static_cast<std::ptrdiff_t>(std::min(size, impl_->output.size()));
    impl_->output.erase(impl_->output.begin(), impl_->output.begin() + count);
}

TimePoint ModbusClient::next_deadline() const
{
    const auto first = std::ranges::min_element(impl_->sent, {}, &PendingRequest::deadline);
    return first == impl_->sent.end() ? no_deadline : first->deadline;
}

void ModbusClient::handle_deadline(TimePoint now)
{
    impl_->expire(now);
    if (impl_->options.max_silent != 0 && impl_->silent >= impl_->options.max_silent) {
        impl_->close(status::Bad_Timeout,
                     "the peer was silent for " + std::to_string(impl_->silent) + " timeouts");
    }
    impl_->send_waiting(now);
}

void ModbusClient::close(StatusCode status, std::string reason)
{
    impl_->close(status, std::move(reason));
}

bool ModbusClient::is_closed() const
{
    return impl_->is_closed;
}

std::size_t ModbusClient::under_way() const
{
    return impl_->sent.size();
}

const ModbusClientCounters& ModbusClient::counters() const
{
    return impl_->counters;
}

} // namespace busbar::backend
