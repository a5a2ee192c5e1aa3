#include "slmp_line.hpp"

#include <utility>

#include <busbar/backend/slmp_end_code.hpp>
#include <busbar/core/status_codes.hpp>

namespace busbar::backend::detail {

namespace {

constexpr std::uint16_t locked = 0xC201;
constexpr std::uint16_t wrong_password = 0xC810;

SlmpClientOptions client_of(const SlmpProtocolOptions& options, const SlmpFindings& findings)
{
    SlmpClientOptions client = options.client;
    client.frame = findings.frame;
    return client;
}

} // namespace

SlmpLine::SlmpLine(const SlmpProtocolOptions& options, SlmpFindings& findings, TimePoint now)
    : options_{options}, frame_{findings.frame}, client_{client_of(options, findings)},
      findings_{findings}, now_{now}
{
    if (options.password.empty()) {
        ask_first(SlmpCommand::TypeName, {});
    } else {
        ask_first(SlmpCommand::Unlock, options.password);
    }
}

SlmpLine::~SlmpLine()
{
    // No answer to the first request: the other frame has its turn.
    if (findings_.may_change && !has_answered_) {
        findings_.frame = frame_ == SlmpFrame::Frame4E ? SlmpFrame::Frame3E : SlmpFrame::Frame4E;
    }
}

void SlmpLine::ask_first(SlmpCommand command, std::string text)
{
    SlmpOperation question;
    question.command = command_ = command;
    question.text = std::move(text);
    const auto sent = client_.send(std::move(question), now_);
    if (sent) {
        asked_ = *sent;
    } else {
        client_.close(sent.error(), "the first request cannot be sent");
    }
}

Result<void> SlmpLine::feed(std::span<const std::byte> in, TimePoint now)
{
    now_ = now;
    auto fed = client_.feed(in, now);
    look();
    return fed;
}

void SlmpLine::handle_deadline(TimePoint now)
{
    now_ = now;
    client_.handle_deadline(now);
    look();
}

Result<std::uint64_t> SlmpLine::ask(SlmpOperation operation, TimePoint now)
{
    now_ = now;
    return client_.send(std::move(operation), now);
}

void SlmpLine::take_first(const SlmpEvent& event)
{
    const std::uint16_t code = event.answer.end_code;
    if (event.status.is_bad()) {
        client_.close(status::Bad_Timeout, frame_ == SlmpFrame::Frame4E
                                               ? "it has no answer to a frame 4E"
                                               : "it has no answer to a frame 3E");
        return;
    }
    if (command_ == SlmpCommand::Unlock && code == 0) {
        ask_first(SlmpCommand::TypeName, {});
        return;
    }
    // A PLC that counts wrong passwords would stay locked: the device waits long before the next.
    is_denied_ = code == wrong_password;
    std::string trouble = command_ == SlmpCommand::Unlock || code == locked
                              ? slmp_end_code_text(code)
                              : findings_.learn(event.answer.text, code);
    if (!trouble.empty()) {
        client_.close(status::Bad_ConfigurationError, std::move(trouble));
        return;
    }
    identity_.product = event.answer.text;
    identity_.family = name_of(findings_.family);
    is_ready_ = true;
}

void SlmpLine::look()
{
    while (auto event = client_.next_event()) {
        if (event->kind == SlmpEvent::Kind::Closed) {
            reason_ = std::move(event->reason);
            continue;
        }
        has_answered_ = has_answered_ || !event->status.is_bad();
        if (event->id == asked_) {
            take_first(*event);
        } else {
            answered(*std::move(event));
        }
    }
}

} // namespace busbar::backend::detail
