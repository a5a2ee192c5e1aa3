#include <busbar/harness/slmp_responder.hpp>

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "backend/slmp/frame_queue.hpp"
#include "harness/slmp/plc_memory.hpp"

namespace busbar::harness {

namespace {

using backend::SlmpAnswer;
using backend::SlmpBlock;
using backend::SlmpCommand;
using backend::SlmpHead;
using backend::SlmpOperation;
using detail::PlcMemory;
using Access = PlcMemory::Access;

constexpr std::uint16_t done = 0;
constexpr std::uint16_t not_in_run = 0x0055;
constexpr std::uint16_t too_many_words = 0xC051;
constexpr std::uint16_t too_many_bits = 0xC052;
constexpr std::uint16_t too_many_random_bits = 0xC053;
constexpr std::uint16_t too_many_random = 0xC054;
constexpr std::uint16_t unknown_command = 0xC059;
constexpr std::uint16_t wrong_device = 0xC05B;
constexpr std::uint16_t wrong_content = 0xC05C;
constexpr std::uint16_t no_monitor = 0xC05D;
constexpr std::uint16_t locked_port = 0xC201;
constexpr std::uint16_t wrong_password = 0xC810;
/// A longer request is not one that a PLC has room for.
constexpr std::size_t max_request = 16'384;

struct Waiting {
    TimePoint due{};
    std::vector<std::byte> frame{};
};

struct Mishap {
    SlmpMishap kind{SlmpMishap::None};
    std::size_t count{0};
    std::uint16_t end_code{0};
};

bool is_write(SlmpCommand command)
{
    using enum SlmpCommand;
    return command == BatchWrite || command == RandomWrite || command == BlockWrite ||
           command == LabelArrayWrite || command == LabelRandomWrite;
}

bool is_label(SlmpCommand command)
{
    using enum SlmpCommand;
    return command == LabelArrayRead || command == LabelArrayWrite || command == LabelRandomRead ||
           command == LabelRandomWrite;
}

std::size_t points_of(const std::vector<SlmpBlock>& blocks)
{
    std::size_t points = 0;
    for (const SlmpBlock& block : blocks) {
        points += block.points;
    }
    return points;
}

/// What the connections to a PLC share.
struct SharedPlc {
    SlmpPlcOptions options;
    PlcMemory memory{};
    detail::PlcLabels labels{};
    std::deque<Mishap> mishaps{};
    std::uint64_t served{0};
    bool is_running{true};
};

} // namespace

struct SlmpResponder::Impl {
    explicit Impl(std::shared_ptr<SharedPlc> its_plc) : plc{std::move(its_plc)}
    {
        is_locked = !plc->options.password.empty();
    }

    void take(std::span<const std::byte> frame, TimePoint now);
    void serve(std::span<const std::byte> frame);
    void send(const SlmpHead& head, const SlmpOperation& operation, const SlmpAnswer& answer,
              const Mishap& mishap);
    [[nodiscard]] Mishap next_mishap();

    [[nodiscard]] std::uint16_t serve(const SlmpOperation& operation, SlmpAnswer& answer);
    [[nodiscard]] std::uint16_t check(const SlmpOperation& operation) const;
    [[nodiscard]] std::uint16_t check_size(const SlmpOperation& operation) const;
    [[nodiscard]] std::uint16_t read(const SlmpOperation& operation, SlmpAnswer& answer) const;
    [[nodiscard]] std::uint16_t write(const SlmpOperation& operation);
    [[nodiscard]] std::uint16_t control(const SlmpOperation& operation);
    [[nodiscard]] std::uint16_t end_code_of(Access access) const;

    std::shared_ptr<SharedPlc> plc;
    std::optional<SlmpOperation> monitor{};
    std::deque<Waiting> waiting{};
    std::vector<std::byte> input{};
    backend::detail::SlmpFrameQueue output{};
    bool is_locked{false};
    bool is_closed{false};
};

std::uint16_t SlmpResponder::Impl::end_code_of(Access access) const
{
    switch (access) {
    case Access::Done:
        return done;
    case Access::UnknownDevice:
        return plc->options.is_fx5 ? wrong_content : wrong_device;
    case Access::OutOfRange:
        return plc->options.is_fx5 ? 0xC056 : 0x4031;
    case Access::NotInBits:
        break;
    }
    return wrong_content;
}

std::uint16_t SlmpResponder::Impl::check_size(const SlmpOperation& operation) const
{
    using enum SlmpCommand;
    const std::size_t random = operation.blocks.size() + operation.more_blocks.size();
    const std::size_t divisor = operation.has_long_form ? 2 : 1;
    switch (operation.command) {
    case BatchRead:
    case BatchWrite: {
        const std::size_t points = operation.blocks[0].points;
        const bool fits = points > 0 && points <= (operation.is_bits ? plc->options.max_bits
                                                                     : plc->options.max_words);
        // FX5 has these two the other way round.
        return fits                                       ? done
               : operation.is_bits != plc->options.is_fx5 ? too_many_bits
                                                          : too_many_words;
    }
    case RandomRead:
    case RegisterMonitor:
        return random > 0 && random <= plc->options.max_random / divisor ? done : too_many_random;
    case RandomWrite:
        if (operation.is_bits) {
            return random <= plc->options.max_random_bits / divisor ? done : too_many_random_bits;
        }
        return 12 * operation.blocks.size() + 14 * operation.more_blocks.size() <=
                       2 * plc->options.max_words / divisor
                   ? done
                   : too_many_random;
    case BlockRead:
        return points_of(operation.blocks) + points_of(operation.more_blocks) <=
                       plc->options.max_words
                   ? done
                   : too_many_words;
    case BlockWrite:
        return points_of(operation.blocks) + points_of(operation.more_blocks) + 9 * random <=
                       plc->options.max_words
                   ? done
                   : too_many_words;
    default:
        return done;
    }
}

std::uint16_t SlmpResponder::Impl::check(const SlmpOperation& operation) const
{
    using enum SlmpCommand;
    if (is_locked && operation.command != Unlock && operation.command != Lock) {
        return locked_port;
    }
    const bool is_monitor =
        operation.command == RegisterMonitor || operation.command == ReadMonitor;
    if ((operation.has_long_form && !plc->options.takes_long_form) ||
        (is_label(operation.command) && !plc->options.has_labels) ||
        (is_monitor && !plc->options.has_monitor) ||
        (operation.command == TypeName && !plc->options.has_type_name)) {
        return unknown_command;
    }
    if (is_write(operation.command) && plc->is_running && !plc->options.is_written_in_run) {
        return not_in_run;
    }
    if (operation.command == BlockWrite && !operation.blocks.empty() &&
        !operation.more_blocks.empty() && !plc->options.takes_mixed_blocks) {
        return wrong_device;
    }
    return check_size(operation);
}

std::uint16_t SlmpResponder::Impl::read(const SlmpOperation& operation, SlmpAnswer& answer) const
{
    const bool is_listed = operation.command == SlmpCommand::RandomRead;
    for (const auto* const blocks : {&operation.blocks, &operation.more_blocks}) {
        const std::size_t words = is_listed && blocks == &operation.more_blocks ? 2 : 1;
        for (const SlmpBlock& block : *blocks) {
            const std::size_t begin = answer.words.size();
            answer.words.resize(begin + block.points * words);
            const auto values = std::span{answer.words}.subspan(begin);
            if (const auto end_code =
                    plc->memory.refusal(block.device, values.size(), operation.is_bits);
                end_code != done) {
                return end_code;
            }
            const Access access = operation.is_bits ? plc->memory.read_bits(block.device, values)
                                                    : plc->memory.read_words(block.device, values);
            if (access != Access::Done) {
                return end_code_of(access);
            }
        }
    }
    return done;
}

std::uint16_t SlmpResponder::Impl::write(const SlmpOperation& operation)
{
    const bool is_listed = operation.command == SlmpCommand::RandomWrite;
    // First without an effect: a request is written as a whole or not at all.
    for (const bool has_effect : {false, true}) {
        std::span<const std::uint16_t> rest{operation.words};
        for (const auto* const blocks : {&operation.blocks, &operation.more_blocks}) {
            const std::size_t words = is_listed && blocks == &operation.more_blocks ? 2 : 1;
            for (const SlmpBlock& block : *blocks) {
                const auto values = rest.first(block.points * words);
                rest = rest.subspan(values.size());
                if (const auto end_code =
                        plc->memory.refusal(block.device, values.size(), operation.is_bits);
                    end_code != done) {
                    return end_code;
                }
                const Access access =
                    !has_effect ? plc->memory.check(block.device, values.size(), operation.is_bits)
                    : operation.is_bits ? plc->memory.write_bits(block.device, values)
                                        : plc->memory.write_words(block.device, values);
                if (access != Access::Done) {
                    return end_code_of(access);
                }
            }
        }
    }
    return done;
}

std::uint16_t SlmpResponder::Impl::control(const SlmpOperation& operation)
{
    switch (operation.command) {
    case SlmpCommand::Unlock:
        if (!plc->options.password.empty() && operation.text != plc->options.password) {
            return wrong_password;
        }
        is_locked = false;
        return done;
    case SlmpCommand::Lock:
        is_locked = !plc->options.password.empty();
        return done;
    case SlmpCommand::RemoteRun:
        plc->is_running = true;
        return done;
    case SlmpCommand::RemoteStop:
    case SlmpCommand::RemotePause:
        plc->is_running = false;
        return done;
    case SlmpCommand::RemoteLatchClear:
    case SlmpCommand::RemoteReset:
        return plc->is_running ? std::uint16_t{0x4013} : done;
    default:
        return done;
    }
}

std::uint16_t SlmpResponder::Impl::serve(const SlmpOperation& operation, SlmpAnswer& answer)
{
    using enum SlmpCommand;
    if (const std::uint16_t refused = check(operation); refused != done) {
        return refused;
    }
    switch (operation.command) {
    case BatchRead:
    case RandomRead:
    case BlockRead:
        return read(operation, answer);
    case BatchWrite:
    case RandomWrite:
    case BlockWrite:
        return write(operation);
    case RegisterMonitor: {
        SlmpOperation registered = operation;
        registered.command = RandomRead;
        const std::uint16_t end_code = read(registered, answer);
        answer.words.clear();
        monitor = end_code == done ? std::optional{std::move(registered)} : std::nullopt;
        return end_code;
    }
    case ReadMonitor:
        return monitor ? read(*monitor, answer) : no_monitor;
    case LabelArrayRead:
    case LabelArrayWrite:
    case LabelRandomRead:
    case LabelRandomWrite:
        return plc->labels.serve(operation, answer);
    case TypeName:
        answer.text = plc->options.type_name;
        answer.model = plc->options.model;
        return done;
    case SelfTest:
        answer.text = operation.text;
        return done;
    default:
        return control(operation);
    }
}

Mishap SlmpResponder::Impl::next_mishap()
{
    if (plc->mishaps.empty()) {
        return {};
    }
    const Mishap mishap = plc->mishaps.front();
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
    const Mishap mishap = next_mishap();
    const auto operation = backend::decode_slmp_request(*body);
    SlmpOperation known = operation ? *operation : SlmpOperation{};
    SlmpAnswer answer;
    answer.end_code = !operation                           ? operation.error()
                      : mishap.kind == SlmpMishap::Refused ? mishap.end_code
                                                           : serve(known, answer);
    if (answer.end_code != done) {
        answer.error = {(*head)->station, body->command, body->subcommand};
    } else if (known.command == SlmpCommand::ReadMonitor) {
        known.blocks = monitor->blocks;
        known.more_blocks = monitor->more_blocks;
    } else if (known.command == SlmpCommand::RemoteReset) {
        // A PLC that resets itself does not answer.
        is_closed = true;
        return;
    }
    send(**head, known, answer, mishap);
}

void SlmpResponder::Impl::send(const SlmpHead& request, const SlmpOperation& operation,
                               const SlmpAnswer& answer, const Mishap& mishap)
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
    return impl_->plc->memory.add(kind, count);
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
    impl_->is_locked = !impl_->plc->options.password.empty();
}

void SlmpResponder::set_running(bool is_running)
{
    impl_->plc->is_running = is_running;
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
