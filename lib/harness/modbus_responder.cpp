#include <busbar/harness/modbus_responder.hpp>

#include <algorithm>
#include <utility>

#include "backend/modbus/frame_buffer.hpp"

namespace busbar::harness {

namespace {

using backend::ModbusException;
using backend::ModbusHeader;
using Bytes = std::vector<std::byte>;
using ModbusFaultKind = ModbusFault::Kind;

/// A request that is executed when it is due.
struct WaitingRequest {
    TimePoint due{};
    ModbusHeader header{};
    Bytes pdu{};
    std::optional<ModbusFault> fault{};
};

[[nodiscard]] Bytes framed(ModbusHeader header, const Bytes& pdu)
{
    Bytes bytes;
    header.pdu_size = pdu.size();
    encode_modbus(header, bytes);
    bytes.insert(bytes.end(), pdu.begin(), pdu.end());
    return bytes;
}

[[nodiscard]] Bytes exception_of(std::span<const std::byte> pdu, ModbusException exception)
{
    constexpr std::byte is_exception{0x80};
    return {pdu[0] | is_exception, static_cast<std::byte>(exception)};
}

/// Makes a frame wrong in its header or its first byte.
void spoil(Bytes& frame, ModbusFaultKind kind)
{
    constexpr std::size_t protocol = 2;
    constexpr std::size_t length = 4;
    constexpr std::byte one{1};
    constexpr std::byte far_off{0x80};
    switch (kind) {
    case ModbusFaultKind::WrongTransaction:
        // Not one that another request may have: nobody could tell these two apart.
        frame[0] ^= far_off;
        break;
    case ModbusFaultKind::WrongUnit:
        frame[backend::modbus_header_size - 1] ^= one;
        break;
    case ModbusFaultKind::WrongFunction:
        frame[backend::modbus_header_size] ^= one;
        break;
    case ModbusFaultKind::OtherProtocol:
        frame[protocol] ^= one;
        break;
    case ModbusFaultKind::Oversize:
        frame[length] = frame[length + 1] = std::byte{0xFF};
        break;
    case ModbusFaultKind::Undersize:
        frame[length] = frame[length + 1] = std::byte{0};
        break;
    default:
        break;
    }
}

} // namespace

struct ModbusResponder::Impl {
    Impl(ModbusDevice& its_device, ModbusResponderOptions given)
        : device{&its_device}, options{given}
    {
    }

    void take(const ModbusHeader& header, std::span<const std::byte> pdu, TimePoint now)
    {
        using Overlap = ModbusResponderOptions::Overlap;
        if (!waiting.empty() && options.overlap == Overlap::Ignore) {
            return;
        }
        const bool is_busy = !waiting.empty() && options.overlap == Overlap::Busy;
        if (is_busy || waiting.size() >= options.max_queue) {
            put(framed(header, exception_of(pdu, ModbusException::DeviceBusy)));
            return;
        }
        WaitingRequest request;
        request.header = header;
        request.pdu.assign(pdu.begin(), pdu.end());
        request.fault = device->next_fault();
        free_at = std::max(free_at, now) + options.latency;
        request.due = at_scan(free_at);
        if (request.fault && request.fault->kind == ModbusFaultKind::Late) {
            request.due += request.fault->delay;
        }
        waiting.push_back(std::move(request));
    }

    [[nodiscard]] TimePoint at_scan(TimePoint time) const
    {
        if (options.scan <= Duration{0}) {
            return time;
        }
        const Duration past = time.time_since_epoch() % options.scan;
        return past == Duration{0} ? time : time + (options.scan - past);
    }

    void execute_due(TimePoint now)
    {
        while (!is_closed) {
            const auto next = std::ranges::min_element(
                waiting, {}, [](const WaitingRequest& request) { return request.due; });
            if (next == waiting.end() || next->due > now) {
                return;
            }
            const WaitingRequest request = std::move(*next);
            waiting.erase(next);
            execute(request);
        }
    }

    void execute(const WaitingRequest& request)
    {
        const ModbusFaultKind kind = request.fault ? request.fault->kind : ModbusFaultKind::Late;
        auto pdu = kind == ModbusFaultKind::Exception
                       ? exception_of(request.pdu, request.fault->exception)
                       : device->answer(request.header.unit, request.pdu);
        if (!pdu || kind == ModbusFaultKind::Silent) {
            return;
        }
        if (kind == ModbusFaultKind::Short) {
            pdu->resize(pdu->size() - std::min(request.fault->bytes, pdu->size() - 1));
        } else if (kind == ModbusFaultKind::Long) {
            pdu->resize(std::min(pdu->size() + request.fault->bytes, backend::max_modbus_pdu_size));
        }
        Bytes frame = framed(request.header, *pdu);
        spoil(frame, kind);
        if (kind == ModbusFaultKind::Overtaken) {
            overtaken = std::move(frame);
            return;
        }
        if (kind == ModbusFaultKind::Cut) {
            frame.resize(std::min(request.fault->bytes, frame.size()));
            is_closed = true;
        }
        put(frame);
        if (kind == ModbusFaultKind::Twice) {
            put(frame);
        }
        put(std::exchange(overtaken, {}));
    }

    void put(const Bytes& frame) { output.insert(output.end(), frame.begin(), frame.end()); }

    ModbusDevice* device;
    ModbusResponderOptions options;
    backend::detail::ModbusFrameBuffer input;
    std::vector<WaitingRequest> waiting;
    /// When the last request in the queue is finished.
    TimePoint free_at{};
    Bytes overtaken;
    Bytes output;
    bool is_closed{false};
};

ModbusResponder::ModbusResponder(ModbusDevice& device, ModbusResponderOptions options)
    : impl_{std::make_unique<Impl>(device, options)}
{
}

ModbusResponder::ModbusResponder(ModbusResponder&&) noexcept = default;
ModbusResponder& ModbusResponder::operator=(ModbusResponder&&) noexcept = default;
ModbusResponder::~ModbusResponder() = default;

Result<void> ModbusResponder::feed(std::span<const std::byte> in, TimePoint now)
{
    while (!impl_->is_closed && !in.empty()) {
        in = in.subspan(impl_->input.take(in));
        const auto frame = impl_->input.frame();
        if (!frame) {
            impl_->is_closed = true;
            return fail(frame.error());
        }
        if (*frame) {
            impl_->take((*frame)->header, (*frame)->pdu, now);
            impl_->input.drop_frame();
            impl_->execute_due(now);
        }
    }
    return {};
}

std::span<const std::byte> ModbusResponder::output() const
{
    return impl_->output;
}

void ModbusResponder::consume(std::size_t size)
{
    const auto count = static_cast<std::ptrdiff_t>(std::min(size, impl_->output.size()));
    impl_->output.erase(impl_->output.begin(), impl_->output.begin() + count);
}

TimePoint ModbusResponder::next_deadline() const
{
    const auto next = std::ranges::min_element(
        impl_->waiting, {}, [](const WaitingRequest& request) { return request.due; });
    return impl_->is_closed || next == impl_->waiting.end() ? no_deadline : next->due;
}

void ModbusResponder::handle_deadline(TimePoint now)
{
    impl_->execute_due(now);
}

void ModbusResponder::set_latency(Duration latency)
{
    impl_->options.latency = latency;
}

bool ModbusResponder::is_closed() const
{
    return impl_->is_closed;
}

} // namespace busbar::harness
