#include "message_stream.hpp"

#include <chrono>

namespace busbar::client::detail {

void MessageStream::heard(DateTime time, TimePoint now)
{
    heard_time = time;
    silences = 0;
    is_server_alive = false;
    has_sign = false;
    silent_at = now + keep_alive_interval + keep_alive_interval / 2 + std::chrono::seconds{1};
}

std::uint32_t MessageStream::fall_silent(TimePoint now)
{
    const std::uint32_t count = silences + 1;
    const bool had_sign = has_sign;
    heard(heard_time, now);
    silences = count;
    has_sign = had_sign;
    is_probing = true;
    probe_count = 0;
    return count;
}

void MessageStream::lose(StatusCode reason)
{
    if (!loss) {
        loss = Loss{reason, complete_until};
    }
}

void MessageStream::begin_session()
{
    republish_at = {};
    republish_failures = 0; // the last connection may have been what failed
    probe_count = 0;
    is_catching_up = false;
}

void MessageStream::catch_up(TimePoint now)
{
    is_probing = true;
    is_catching_up = true;
    heard(heard_time, now);
}

void MessageStream::interrupt()
{
    is_republishing = false;
    silent_at = no_deadline;
}

void MessageStream::restart()
{
    interrupt();
    begin_session();
    is_probing = false;
    heard_time = {};
    sequence.reset();
}

bool MessageStream::needs_republish()
{
    const bool is_needed = is_probing || sequence.is_missing();
    is_catching_up = is_catching_up && is_needed;
    return is_needed;
}

bool MessageStream::is_renumbered(std::uint32_t number)
{
    constexpr std::uint32_t many = 3;
    repeated_count = number == repeated_number + 1 ? repeated_count + 1 : 1;
    repeated_number = number;
    return repeated_count >= many;
}

void MessageStream::republished()
{
    republish_failures = 0;
    if (++probe_count >= sequence.max_missing()) {
        is_probing = false;
    }
}

} // namespace busbar::client::detail
