#include "slmp_line.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include <busbar/core/status_codes.hpp>

namespace busbar::backend::detail {

namespace {

/// The characters of a name that can be shown; a PLC may send any bytes.
std::string shown(std::string_view text)
{
    std::string all;
    std::ranges::copy_if(text, std::back_inserter(all),
                         [](char each) { return each >= ' ' && each <= '~'; });
    return all;
}

} // namespace

SlmpLine::SlmpLine(SlmpClientOptions options, SlmpFindings& findings, TimePoint now)
    : frame_{options.frame}, client_{options}, findings_{findings}, now_{now}
{
    SlmpOperation question;
    question.command = SlmpCommand::TypeName;
    const auto sent = client_.send(std::move(question), now);
    asked_ = sent ? *sent : 0;
    is_ready_ = !sent;
}

SlmpLine::~SlmpLine()
{
    // No answer to the first request: the other frame has its turn.
    if (findings_.may_change && !has_answered_) {
        findings_.frame = frame_ == SlmpFrame::Frame4E ? SlmpFrame::Frame3E : SlmpFrame::Frame4E;
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

void SlmpLine::look()
{
    while (auto event = client_.next_event()) {
        if (event->kind == SlmpEvent::Kind::Closed) {
            reason_ = std::move(event->reason);
            continue;
        }
        has_answered_ = has_answered_ || !event->status.is_bad();
        if (event->id != asked_) {
            answered(*std::move(event));
            continue;
        }
        identity_.product = shown(event->answer.text);
        is_ready_ = !event->status.is_bad();
        if (!is_ready_) {
            client_.close(status::Bad_Timeout, frame_ == SlmpFrame::Frame4E
                                                   ? "it has no answer to a frame 4E"
                                                   : "it has no answer to a frame 3E");
        }
    }
}

} // namespace busbar::backend::detail
