#include "harness/slmp/plc_service.hpp"

#include <span>
#include <utility>
#include <vector>

namespace busbar::harness::detail {

namespace {

using backend::SlmpAnswer;
using backend::SlmpBlock;
using backend::SlmpCommand;
using backend::SlmpOperation;
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

bool is_write(SlmpCommand command)
{
    using enum SlmpCommand;
    return command == BatchWrite || command == RandomWrite || command == BlockWrite ||
           command == LabelArrayWrite || command == LabelRandomWrite;
}

bool is_block(SlmpCommand command)
{
    return command == SlmpCommand::BlockRead || command == SlmpCommand::BlockWrite;
}

bool is_random(SlmpCommand command)
{
    return command == SlmpCommand::RandomRead || command == SlmpCommand::RandomWrite;
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

} // namespace

std::uint16_t PlcService::end_code_of(Access access) const
{
    switch (access) {
    case Access::Done:
        return done;
    case Access::UnknownDevice:
        return plc_->options.is_fx5 ? wrong_content : wrong_device;
    case Access::OutOfRange:
        return plc_->options.is_fx5 ? 0xC056 : 0x4031;
    case Access::NotInBits:
        break;
    }
    return wrong_content;
}

std::uint16_t PlcService::check_size(const SlmpOperation& operation) const
{
    using enum SlmpCommand;
    const std::size_t random = operation.blocks.size() + operation.more_blocks.size();
    const std::size_t divisor = operation.has_long_form ? 2 : 1;
    switch (operation.command) {
    case BatchRead:
    case BatchWrite: {
        const std::size_t points = operation.blocks[0].points;
        const bool fits = points > 0 && points <= (operation.is_bits ? plc_->options.max_bits
                                                                     : plc_->options.max_words);
        // FX5 has these two the other way round.
        return fits                                        ? done
               : operation.is_bits != plc_->options.is_fx5 ? too_many_bits
                                                           : too_many_words;
    }
    case RandomRead:
    case RegisterMonitor:
        return random > 0 && random <= plc_->options.max_random / divisor ? done : too_many_random;
    case RandomWrite:
        if (operation.is_bits) {
            return random <= plc_->options.max_random_bits / divisor ? done : too_many_random_bits;
        }
        return 12 * operation.blocks.size() + 14 * operation.more_blocks.size() <=
                       2 * plc_->options.max_words / divisor
                   ? done
                   : too_many_random;
    case BlockRead:
        return random <= plc_->options.max_blocks / divisor &&
                       points_of(operation.blocks) + points_of(operation.more_blocks) <=
                           plc_->options.max_words
                   ? done
                   : too_many_words;
    case BlockWrite:
        return random <= plc_->options.max_blocks / divisor &&
                       points_of(operation.blocks) + points_of(operation.more_blocks) +
                               9 * random <=
                           plc_->options.max_words
                   ? done
                   : too_many_words;
    default:
        return done;
    }
}

std::uint16_t PlcService::check(const SlmpOperation& operation) const
{
    using enum SlmpCommand;
    if (is_locked_ && operation.command != Unlock && operation.command != Lock) {
        return locked_port;
    }
    const bool is_monitor =
        operation.command == RegisterMonitor || operation.command == ReadMonitor;
    if ((operation.has_long_form && !plc_->options.takes_long_form) ||
        (is_label(operation.command) && !plc_->options.has_labels) ||
        (is_monitor && !plc_->options.has_monitor) ||
        (is_block(operation.command) && !plc_->options.has_blocks) ||
        (is_random(operation.command) && !plc_->options.has_random) ||
        (operation.command == TypeName && !plc_->options.has_type_name)) {
        return unknown_command;
    }
    if (is_write(operation.command) && plc_->is_running && !plc_->options.is_written_in_run) {
        return not_in_run;
    }
    if (operation.command == BlockWrite && !operation.blocks.empty() &&
        !operation.more_blocks.empty() && !plc_->options.takes_mixed_blocks) {
        return wrong_device;
    }
    return check_size(operation);
}

std::uint16_t PlcService::read(const SlmpOperation& operation, SlmpAnswer& answer) const
{
    const bool is_listed = operation.command == SlmpCommand::RandomRead;
    for (const auto* const blocks : {&operation.blocks, &operation.more_blocks}) {
        const std::size_t words = is_listed && blocks == &operation.more_blocks ? 2 : 1;
        for (const SlmpBlock& block : *blocks) {
            const std::size_t begin = answer.words.size();
            answer.words.resize(begin + block.points * words);
            const auto values = std::span{answer.words}.subspan(begin);
            if (const auto end_code =
                    plc_->memory.refusal(block.device, values.size(), operation.is_bits);
                end_code != done) {
                return end_code;
            }
            const Access access = operation.is_bits ? plc_->memory.read_bits(block.device, values)
                                                    : plc_->memory.read_words(block.device, values);
            if (access != Access::Done) {
                return end_code_of(access);
            }
        }
    }
    return done;
}

std::uint16_t PlcService::write(const SlmpOperation& operation)
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
                        plc_->memory.refusal(block.device, values.size(), operation.is_bits);
                    end_code != done) {
                    return end_code;
                }
                const Access access =
                    !has_effect ? plc_->memory.check(block.device, values.size(), operation.is_bits)
                    : operation.is_bits ? plc_->memory.write_bits(block.device, values)
                                        : plc_->memory.write_words(block.device, values);
                if (access != Access::Done) {
                    return end_code_of(access);
                }
            }
        }
    }
    return done;
}

std::uint16_t PlcService::control(const SlmpOperation& operation)
{
    switch (operation.command) {
    case SlmpCommand::Unlock:
        if (!plc_->options.password.empty() && operation.text != plc_->options.password) {
            return wrong_password;
        }
        is_locked_ = false;
        return done;
    case SlmpCommand::Lock:
        is_locked_ = !plc_->options.password.empty();
        return done;
    case SlmpCommand::RemoteRun:
        plc_->set_mode(SharedPlc::run);
        return done;
    case SlmpCommand::RemoteStop:
    case SlmpCommand::RemotePause:
        plc_->set_mode(operation.command == SlmpCommand::RemoteStop ? SharedPlc::stop
                                                                    : SharedPlc::pause);
        return done;
    case SlmpCommand::RemoteLatchClear:
    case SlmpCommand::RemoteReset:
        return plc_->is_running ? std::uint16_t{0x4013} : done;
    default:
        return done;
    }
}

std::uint16_t PlcService::serve(const SlmpOperation& operation, SlmpAnswer& answer)
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
        monitor_ = end_code == done ? std::optional{std::move(registered)} : std::nullopt;
        return end_code;
    }
    case ReadMonitor:
        return monitor_ ? read(*monitor_, answer) : no_monitor;
    case LabelArrayRead:
    case LabelArrayWrite:
    case LabelRandomRead:
    case LabelRandomWrite:
        return plc_->labels.serve(operation, answer);
    case TypeName:
        answer.text = plc_->options.type_name;
        answer.model = plc_->options.model;
        return done;
    case SelfTest:
        answer.text = operation.text;
        return done;
    default:
        return control(operation);
    }
}

} // namespace busbar::harness::detail
