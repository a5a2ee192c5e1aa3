#include "stream.hpp"

#include <poll.h>

#include <CLI/CLI.hpp>

#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/value.hpp"

namespace busbar::tool {

namespace {

/// Returns the present result of poll() for a descriptor; -1 for none.
short polled(int descriptor)
{
    ::pollfd input{descriptor, POLLIN, 0};
    return descriptor >= 0 && ::poll(&input, 1, 0) > 0 ? input.revents : short{0};
}

/// True if the terminal is gone: then it is always readable.
bool is_gone(int descriptor)
{
    return (polled(descriptor) & (POLLHUP | POLLERR | POLLNVAL)) != 0;
}

} // namespace

void add_stream_options(CLI::App& command, StreamEnd& end)
{
    command.add_option("-n,--count", end.count, "end after so many; 0 for no end")->type_name("N");
    command.add_option("--duration", end.seconds, "end after so long; 0 for no end")
        ->type_name("SECONDS");
}

void StreamReporter::lost(StatusCode why)
{
    report("connection lost (" + text_of(why) + "), trying again");
}

void StreamReporter::back()
{
    report("connected again");
}

void StreamReporter::polling()
{
    report("the server has no subscriptions: values are read instead");
}

void StreamReporter::missed(const client::Gap& gap)
{
    if (!context_->options.is_json) {
        report("something may be missing between " + time_of_day(gap.from) + " and " +
               time_of_day(gap.to) + ": " + text_of(gap.reason));
        return;
    }
    JsonLine json;
    json.open_object().key("gap").open_object();
    json.member("from", gap.from).member("to", gap.to).member("reason", gap.reason);
    context_->out.line(json.close_object().close_object().document());
}

void StreamReporter::report(const std::string& text)
{
    if (!context_->options.is_json) {
        context_->err.line("busbar: " + text);
    }
}

Stream::Stream(Context& context, Connection& connection, const StreamEnd& end)
    : Stream{context, connection, end, std::make_unique<StreamReporter>(context)}
{
}

Stream::Stream(Context& context, Connection& connection, const StreamEnd& end,
               std::unique_ptr<StreamListener> listener)
    : context_{&context}, connection_{&connection}, listener_{std::move(listener)}, end_{end}
{
    watch_connection();
}

Stream::~Stream()
{
    connection_->close();
    connection_->client().on_state(nullptr); // a server that does not answer is still connected
}

void Stream::watch_connection()
{
    connection_->client().on_state([this](client::ClientState state, StatusCode why) {
        if (state == client::ClientState::Waiting && !was_lost_) {
            was_lost_ = true;
            push([this, why] { listener_->lost(why); });
        } else if (state == client::ClientState::Ready && was_lost_) {
            was_lost_ = false;
            push([this] { listener_->back(); });
        } else if (state == client::ClientState::Closed && why.is_bad()) {
            push([this, why] { throw Failure{why, context_->options.url}; });
        }
    });
}

bool Stream::count()
{
    if (has_enough()) {
        return false;
    }
    ++counted_;
    return true;
}

bool Stream::has_enough() const
{
    return end_.count != 0 && counted_ >= end_.count;
}

void Stream::wake_on(int descriptor)
{
    // If waiting for it is impossible, run() looks now and then.
    if (connection_->blocking().wake_on(descriptor)) {
        input_ = descriptor;
    }
}

bool Stream::has_lost_input() const
{
    return is_gone(input_);
}

bool Stream::has_input() const
{
    return (polled(input_) & POLLIN) != 0;
}

void Stream::run(const std::function<void()>& tick)
{
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    const auto is_over = [&] {
        const std::chrono::duration<double> passed = Clock::now() - begin;
        return is_stopped_ || has_lost_input() || (has_enough() && is_complete_()) ||
               (end_.seconds > 0 && passed.count() >= end_.seconds);
    };
    while (!is_over() && !connection_->is_interrupted()) {
        connection_->blocking().run_until([this] { return !work_.empty() || has_input(); },
                                          std::chrono::milliseconds{100});
        for (auto work = std::exchange(work_, {}); !work.empty(); work.pop_front()) {
            work.front()();
        }
        tick();
    }
    if (connection_->is_interrupted()) {
        throw Interrupted{};
    }
}

client::SubscriptionHandlers Stream::handlers()
{
    client::SubscriptionHandlers handlers;
    handlers.on_gap = [this](const client::Gap& gap) {
        push([this, gap] { listener_->missed(gap); });
    };
    handlers.on_status = [this](StatusCode status, client::DeliveryMode mode,
                                const CreateSubscriptionResponse&) {
        if (status.is_bad() && mode == client::DeliveryMode::None && !is_created_) {
            push([status] { throw Failure{status, "the subscription"}; });
        }
        is_created_ = is_created_ || !status.is_bad();
        if (mode == client::DeliveryMode::Polling) {
            push([this] { listener_->polling(); });
        }
    };
    return handlers;
}

} // namespace busbar::tool
