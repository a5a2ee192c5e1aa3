#include <busbar/harness/slmp_responder.hpp>

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "backend/slmp/frame_queue.hpp"
#include "harness/slmp/plc_service.hpp"

namespace busbar::harness {

namespace {

using backend::SlmpAnswer;
using backend::SlmpCommand;
using backend::SlmpHead;
using backend::SlmpOperation;
using detail::PlcMishap;
using detail::SharedPlc;
using Access = detail::PlcMemory::Access;

constexpr std::uint16_t done = 0;
/// A longer request is not one that a PLC has room for.
constexpr std::size_t max_request = 16'384;

struct Waiting {
    TimePoint due{};
    std::vector<std::byte> frame{};
};

} // namespace

struct SlmpResponder::Impl {
    explicit Impl(std::shared_ptr<SharedPlc> its_plc) : plc{std::move(its_plc)}, service{*plc} {}

    void take(std::span<const std::byte> frame, TimePoint now);
    void serve(std::span<const std::byte> frame);
    void send(const SlmpHead& head, const SlmpOperation& operation, const SlmpAnswer& answer,
              const PlcMishap& mishap);
    [[nodiscard]] PlcMishap next_mishap();

    std::shared_ptr<SharedPlc> plc;
    detail::PlcService service;
    std::deque<Waiting> waiting{};
    std::vector<std::byte> input{};
    backend::detail::SlmpFrameQueue output{};
    bool is_closed{false};
};

PlcMishap SlmpResponder::Impl::next_mishap()
{
    if (plc->mishaps.empty()) {
        return {};
    }
    const PlcMishap mishap = plc->mishaps.front();
    if (--plc->mishaps.front().count == 0) {
        plc->mishaps.pop_front();
    }
    return mishap;
}

void SlmpResponder::Impl::serve(std::span<const std::byte> frame)
{
    const auto head = backend::read_slmp_head(frame);
    const auto body = backend::read_slmp_request(**head, frame);
    if (!body) {
        return;
    }
    ++plc->served;
    const PlcMishap mishap = next_mishap();
    const auto operation = backend::decode_slmp_request(*body);
    SlmpOperation known = operation ? *operation : SlmpOperation{};
    SlmpAnswer answer;
    answer.end_code = !operation                           ? operation.error()
                      : mishap.kind == SlmpMishap::Refused ? mishap.end_code
                                                           : service.serve(known, answer);
    if (answer.end_code != done) {
        answer.error = {(*head)->station, body->command, body->subcommand};
    } else if (known.command == SlmpCommand::ReadMonitor) {
        known.blocks = service.monitor()->blocks;
        known.more_blocks = service.monitor()->more_blocks;
    } else if (known.command == SlmpCommand::RemoteReset) {
        // A PLC that resets itself does not answer.
        is_closed = true;
        return;
    }
    send(**head, known, answer, mishap);
}

void SlmpResponder::Impl::send(const SlmpHead& request, const SlmpOperation& operation,
                               const SlmpAnswer& answer, const PlcMishap& mishap)
{
    SlmpHead head = request;
    if (mishap.kind == SlmpMishap::WrongSerial) {
        head.serial ^= 0x5555U;
        head.station.station ^= head.frame == backend::SlmpFrame::Frame3E ? 0x55U : 0U;
    }
    auto frame = backend::encode_slmp_answer(head, operation, answer);
    if (!frame || mishap.kind == SlmpMishap::Silent) {
        return;
    }
    if (mishap.kind == SlmpMishap::TooShort) {
        const std::size_t size = frame->size() - 2;
        frame->resize(std::max(size, head.head_size + 2));
        (*frame)[head.head_size - 2] = static_cast<std::byte>(frame->size() - head.head_size);
        (*frame)[head.head_size - 1] =
            static_cast<std::byte>((frame->size() - head.head_size) >> 8U);
    }
    is_closed = mishap.kind == SlmpMishap::CutOff || mishap.kind == SlmpMishap::Closed;
    if (mishap.kind == SlmpMishap::Closed) {
        return;
    }
    if (mishap.kind == SlmpMishap::CutOff) {
        frame->resize(frame->size() / 2);
    }
    if (mishap.kind == SlmpMishap::Twice) {
        output.push(*frame);
    }
    output.push(std::move(*frame));
}

void SlmpResponder::Impl::take(std::span<const std::byte> frame, TimePoint now)
{
    const auto head = backend::read_slmp_head(frame);
    const bool has_answer =
        !(*head)->is_response &&
        (plc->options.takes_4e || (*head)->frame == backend::SlmpFrame::Frame3E);
    if (has_answer && plc->options.is_fx5 && !plc->options.is_datagram) {
        // Of requests before the first answer, only the last one has one (measured on FX5U).
        waiting.clear();
    }
    if (has_answer && waiting.size() < std::max<std::size_t>(plc->options.max_waiting, 1)) {
        waiting.push_back({now + plc->options.latency, {frame.begin(), frame.end()}});
    }
}

SlmpResponder::SlmpResponder(SlmpPlcOptions options)
    : SlmpResponder{
          std::make_unique<Impl>(std::make_shared<SharedPlc>(SharedPlc{std::move(options)}))}
{
}

SlmpResponder::SlmpResponder(std::unique_ptr<Impl> impl) : impl_{std::move(impl)} {}

SlmpResponder SlmpResponder::another_connection() const
{
    return SlmpResponder{std::make_unique<Impl>(impl_->plc)};
}

SlmpResponder::SlmpResponder(SlmpResponder&&) noexcept = default;
SlmpResponder& SlmpResponder::operator=(SlmpResponder&&) noexcept = default;
SlmpResponder::~SlmpResponder() = default;

bool SlmpResponder::add_devices(std::string_view kind, std::uint32_t count)
{
    const bool is_added = impl_->plc->memory.add(kind, count);
    if (!impl_->plc->is_running) {
        impl_->plc->set_mode(SharedPlc::stop);
    }
    return is_added;
}

bool SlmpResponder::set(std::string_view text, std::uint16_t value, std::uint32_t word)
{
    const auto address =
        backend::parse_slmp_address(text, {.is_octal = impl_->plc->options.is_fx5});
    if (!address) {
        return false;
    }
    const auto* const type = backend::find_slmp_device_type(address->device.code);
    if (type->unit == backend::SlmpUnit::Bit) {
        return impl_->plc->memory.write_bits(address->device, {&value, 1}) == Access::Done;
    }
    std::vector<std::uint16_t> words(std::size_t{word} + 1);
    if (impl_->plc->memory.read_words(address->device, words) != Access::Done) {
        return false;
    }
    words[word] = value;
    return impl_->plc->memory.write_words(address->device, words) == Access::Done;
}

std::uint16_t SlmpResponder::get(std::string_view text, std::uint32_t word) const
{
    const auto address =
        backend::parse_slmp_address(text, {.is_octal = impl_->plc->options.is_fx5});
    if (!address) {
        return 0;
    }
    const auto* const type = backend::find_slmp_device_type(address->device.code);
    std::vector<std::uint16_t> words(std::size_t{word} + 1);
    const Access access = type->unit == backend::SlmpUnit::Bit
                              ? impl_->plc->memory.read_bits(address->device, {words.data(), 1})
                              : impl_->plc->memory.read_words(address->device, words);
    return access == Access::Done ? words[word] : std::uint16_t{0};
}

void SlmpResponder::add_label(std::string_view name, std::uint8_t type,
                              std::span<const std::byte> value, std::size_t element_size)
{
    impl_->plc->labels.add(name, {type, element_size, {value.begin(), value.end()}});
}

std::span<const std::byte> SlmpResponder::label(std::string_view name) const
{
    const auto* const found = impl_->plc->labels.find(name);
    return found == nullptr ? std::span<const std::byte>{} : std::span{found->value};
}

void SlmpResponder::clear_labels()
{
    impl_->plc->labels.clear();
}

void SlmpResponder::happen(SlmpMishap mishap, std::size_t count, std::uint16_t end_code)
{
    if (count > 0) {
        impl_->plc->mishaps.push_back({mishap, count, end_code});
    }
}

bool SlmpResponder::refuse(std::string_view address, std::uint16_t end_code)
{
    const auto parsed =
        backend::parse_slmp_address(address, {.is_octal = impl_->plc->options.is_fx5});
    if (parsed) {
        impl_->plc->memory.refuse(parsed->device, end_code);
    }
    return parsed.has_value();
}

void SlmpResponder::refuse_none()
{
    impl_->plc->memory.refuse_none();
}

void SlmpResponder::set_latency(Duration latency)
{
    impl_->plc->options.latency = latency;
}

void SlmpResponder::reconnect()
{
    impl_->waiting.clear();
    impl_->input.clear();
    impl_->output.clear();
    impl_->is_closed = false;
    impl_->service.reconnect();
}

void SlmpResponder::set_running(bool is_running)
{
    impl_->plc->set_mode(is_running ? SharedPlc::run : SharedPlc::stop);
}

bool SlmpResponder::is_running() const
{
    return impl_->plc->is_running;
}

std::uint64_t SlmpResponder::served() const
{
    return impl_->plc->served;
}

void SlmpResponder::feed(std::span<const std::byte> in, TimePoint now)
{
    if (impl_->is_closed) {
        return;
    }
    if (impl_->plc->options.is_datagram) {
        const auto head = backend::read_slmp_head(in);
        if (head && *head && (*head)->size == in.size() && in.size() <= max_request) {
            impl_->take(in, now);
        }
        handle_deadline(now);
        return;
    }
    auto& input = impl_->input;
    input.insert(input.end(), in.begin(), in.end());
    std::size_t at = 0;
    while (!impl_->is_closed) {
        const auto rest = std::span<const std::byte>{input}.subspan(at);
        const auto head = backend::read_slmp_head(rest);
        if (!head || (*head && (*head)->size > max_request)) {
            impl_->is_closed = true;
            break;
        }
        if (!*head || rest.size() < (*head)->size) {
            break;
        }
        impl_->take(rest.first((*head)->size), now);
        at += (*head)->size;
        handle_deadline(now);
    }
    input.erase(input.begin(), input.begin() + static_cast<std::ptrdiff_t>(at));
}

std::span<const std::byte> SlmpResponder::output() const
{
    return impl_->output.front();
}

void SlmpResponder::consume(std::size_t size)
{
    impl_->output.consume(size);
}

TimePoint SlmpResponder::next_deadline() const
{
    return impl_->waiting.empty() || impl_->is_closed ? no_deadline : impl_->waiting.front().due;
}

void SlmpResponder::handle_deadline(TimePoint now)
{
    while (next_deadline() <= now) {
        const Waiting request = std::move(impl_->waiting.front());
        impl_->waiting.pop_front();
        impl_->serve(request.frame);
    }
}

bool SlmpResponder::is_closed() const
{
    return impl_->is_closed;
}

} // namespace busbar::harness
