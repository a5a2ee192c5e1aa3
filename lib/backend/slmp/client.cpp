#include <busbar/backend/slmp_client.hpp>

#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include <busbar/core/status_codes.hpp>

namespace busbar::backend {

namespace {

/// A request from send() to its answer.
struct SlmpRequest {
    std::uint32_t handle{0};
    std::uint16_t serial{0};
    SlmpOperation operation{};
    Duration timeout{0};
    /// Until it is in the output.
    std::vector<std::byte> frame{};
    TimePoint sent{};
    TimePoint deadline{no_deadline};
};

} // namespace

struct SlmpClient::Impl {
    explicit Impl(SlmpClientConfig given) : config{given}
    {
        if (config.frame == SlmpFrame::Frame3E || config.max_under_way == 0) {
            config.max_under_way = 1;
        }
    }

    [[nodiscard]] bool has_serial() const { return config.frame == SlmpFrame::Frame4E; }
    [[nodiscard]] std::uint16_t free_serial();
    void start_waiting(TimePoint now);
    void take_stream(std::span<const std::byte> in, TimePoint now);
    void take_datagram(std::span<const std::byte> in, TimePoint now);
    void take_frame(const SlmpHead& head, std::span<const std::byte> frame, TimePoint now);
    /// The request that a response is to; the end of `under_way` if it is to none.
    [[nodiscard]] std::vector<SlmpRequest>::iterator find_request(const SlmpHead& head);
    void refuse_frame(std::vector<SlmpRequest>::iterator request);
    void end(std::vector<SlmpRequest>::iterator request, StatusCode status, SlmpAnswer answer,
             Duration round_trip);
    void close(StatusCode reason);

    SlmpClientConfig config;
    std::deque<SlmpRequest> waiting{};
    std::vector<SlmpRequest> under_way{};
    std::deque<std::vector<std::byte>> output{};
    /// Bytes of the first frame of the output that were sent.
    std::size_t consumed{0};
    std::vector<std::byte> input{};
    std::deque<SlmpEvent> events{};
    std::uint32_t last_handle{0};
    std::uint16_t last_serial{0};
    std::size_t silent{0};
    std::optional<StatusCode> closed{};
    SlmpClientCounters counters{};
};

std::uint16_t SlmpClient::Impl::free_serial()
{
    const auto is_used = [&](const auto& requests) {
        return std::any_of(requests.begin(), requests.end(), [&](const SlmpRequest& request) {
            return request.serial == last_serial;
        });
    };
    do {
        ++last_serial;
    } while (is_used(under_way) || is_used(waiting));
    return last_serial;
}

void SlmpClient::Impl::start_waiting(TimePoint now)
{
    while (!waiting.empty() && under_way.size() < config.max_under_way) {
        SlmpRequest& request = waiting.front();
        output.push_back(std::move(request.frame));
        request.sent = now;
        request.deadline = now + request.timeout;
        under_way.push_back(std::move(request));
        waiting.pop_front();
        ++counters.requests;
    }
}

std::vector<SlmpRequest>::iterator SlmpClient::Impl::find_request(const SlmpHead& head)
{
    if (!head.is_response || head.frame != config.frame || head.station != config.station) {
        return under_way.end();
    }
    return std::find_if(under_way.begin(), under_way.end(), [&](const SlmpRequest& request) {
        return !has_serial() || request.serial == head.serial;
    });
}

void SlmpClient::Impl::take_frame(const SlmpHead& head, std::span<const std::byte> frame,
                                  TimePoint now)
{
    const auto request = find_request(head);
    if (request == under_way.end()) {
        ++counters.unexpected;
        if (!has_serial() && !config.is_datagram) {
            close(status::Bad_UnknownResponse);
        }
        return;
    }
    auto answer = decode_slmp_answer(request->operation, head, frame);
    // An error says which request it is about.
    const bool is_its_own =
        answer &&
        (!answer->error ||
         (answer->error->command == static_cast<std::uint16_t>(request->operation.command) &&
          answer->error->subcommand == slmp_subcommand(request->operation)));
    if (!is_its_own) {
        refuse_frame(request);
        return;
    }
    silent = 0;
    ++counters.answers;
    end(request, status::Good, std::move(*answer), now - request->sent);
    start_waiting(now);
}

void SlmpClient::Impl::refuse_frame(std::vector<SlmpRequest>::iterator request)
{
    if (has_serial()) {
        end(request, status::Bad_DecodingError, {}, {});
        return;
    }
    // It may be the answer to an earlier request, and the next one the answer to this.
    ++counters.unexpected;
    if (!config.is_datagram) {
        close(status::Bad_UnknownResponse);
    }
}

void SlmpClient::Impl::take_stream(std::span<const std::byte> in, TimePoint now)
{
    input.insert(input.end(), in.begin(), in.end());
    std::span<const std::byte> rest{input};
    while (!closed) {
        const auto head = read_slmp_head(rest);
        if (!head) {
            close(status::Bad_CommunicationError);
            break;
        }
        if (*head && (*head)->size > config.max_response) {
            close(status::Bad_ResponseTooLarge);
            break;
        }
        if (!*head || rest.size() < (*head)->size) {
            break;
        }
        take_frame(**head, rest.first((*head)->size), now);
        rest = rest.subspan((*head)->size);
    }
    input.erase(input.begin(), input.end() - static_cast<std::ptrdiff_t>(rest.size()));
}

void SlmpClient::Impl::take_datagram(std::span<const std::byte> in, TimePoint now)
{
    const auto head = read_slmp_head(in);
    if (head && *head && (*head)->size == in.size() && in.size() <= config.max_response) {
        take_frame(**head, in, now);
    } else {
        ++counters.unexpected;
    }
}

void SlmpClient::Impl::end(std::vector<SlmpRequest>::iterator request, StatusCode status,
                           SlmpAnswer answer, Duration round_trip)
{
    events.push_back(
        {SlmpEvent::Kind::Answer, request->handle, status, std::move(answer), round_trip});
    under_way.erase(request);
}

void SlmpClient::Impl::close(StatusCode reason)
{
    if (closed) {
        return;
    }
    closed = reason;
    while (!under_way.empty()) {
        const bool is_reset = under_way.front().operation.command == SlmpCommand::RemoteReset;
        const bool is_by_peer = reason == StatusCode{status::Bad_ConnectionClosed};
        end(under_way.begin(), is_reset && is_by_peer ? StatusCode{} : reason, {}, {});
    }
    for (const SlmpRequest& request : waiting) {
        events.push_back({SlmpEvent::Kind::Answer, request.handle, reason});
    }
    waiting.clear();
    output.clear();
    consumed = 0;
    events.push_back({SlmpEvent::Kind::Closed, 0, reason});
}

SlmpClient::SlmpClient(SlmpClientConfig config) : impl_{std::make_unique<Impl>(config)} {}

SlmpClient::SlmpClient(SlmpClient&&) noexcept = default;
SlmpClient& SlmpClient::operator=(SlmpClient&&) noexcept = default;
SlmpClient::~SlmpClient() = default;

Result<std::uint32_t> SlmpClient::send(SlmpOperation operation, TimePoint now, Duration timeout)
{
    if (impl_->closed) {
        return fail(status::Bad_ConnectionClosed);
    }
    if (impl_->waiting.size() >= impl_->config.max_waiting && free_places() == 0) {
        return fail(status::Bad_TooManyOperations);
    }
    SlmpHead head{.frame = impl_->config.frame, .station = impl_->config.station};
    head.serial = impl_->has_serial() ? impl_->free_serial() : std::uint16_t{0};
    auto frame = encode_slmp_request(head, impl_->config.timer, operation);
    if (!frame) {
        return fail(frame.error());
    }
    SlmpRequest request;
    request.handle = ++impl_->last_handle;
    request.serial = head.serial;
    request.operation = std::move(operation);
    request.timeout = timeout > Duration{0} ? timeout : impl_->config.timeout;
    request.frame = std::move(*frame);
    impl_->waiting.push_back(std::move(request));
    impl_->start_waiting(now);
    return impl_->last_handle;
}

std::size_t SlmpClient::free_places() const
{
    const std::size_t used = impl_->under_way.size() + impl_->waiting.size();
    return impl_->closed || used >= impl_->config.max_under_way
               ? 0
               : impl_->config.max_under_way - used;
}

Result<void> SlmpClient::feed(std::span<const std::byte> in, TimePoint now)
{
    if (!impl_->closed) {
        if (impl_->config.is_datagram) {
            impl_->take_datagram(in, now);
        } else {
            impl_->take_stream(in, now);
        }
    }
    return impl_->closed ? Result<void>{fail(*impl_->closed)} : Result<void>{};
}

std::optional<SlmpEvent> SlmpClient::next_event()
{
    if (impl_->events.empty()) {
        return std::nullopt;
    }
    SlmpEvent event = std::move(impl_->events.front());
    impl_->events.pop_front();
    return event;
}

std::span<const std::byte> SlmpClient::output() const
{
    return impl_->output.empty() ? std::span<const std::byte>{}
                                 : std::span{impl_->output.front()}.subspan(impl_->consumed);
}

void SlmpClient::consume(std::size_t size)
{
    if (impl_->output.empty()) {
        return;
    }
    impl_->consumed += size;
    if (impl_->consumed >= impl_->output.front().size()) {
        impl_->output.pop_front();
        impl_->consumed = 0;
    }
}

TimePoint SlmpClient::next_deadline() const
{
    TimePoint next = no_deadline;
    for (const SlmpRequest& request : impl_->under_way) {
        next = std::min(next, request.deadline);
    }
    return next;
}

void SlmpClient::handle_deadline(TimePoint now)
{
    const auto is_over = [&](const SlmpRequest& request) { return request.deadline <= now; };
    for (auto request = std::find_if(impl_->under_way.begin(), impl_->under_way.end(), is_over);
         request != impl_->under_way.end();
         request = std::find_if(impl_->under_way.begin(), impl_->under_way.end(), is_over)) {
        ++impl_->counters.timeouts;
        ++impl_->silent;
        impl_->end(request, status::Bad_Timeout, {}, {});
    }
    const bool is_lost = impl_->silent >= std::max<std::size_t>(impl_->config.max_silent, 1) ||
                         (impl_->silent > 0 && !impl_->has_serial());
    if (is_lost) {
        impl_->close(status::Bad_Timeout);
    } else {
        impl_->start_waiting(now);
    }
}

void SlmpClient::close(StatusCode reason)
{
    impl_->close(reason.is_bad() ? reason : StatusCode{status::Bad_ConnectionClosed});
}

bool SlmpClient::is_closed() const
{
    return impl_->closed.has_value();
}

const SlmpClientCounters& SlmpClient::counters() const
{
    return impl_->counters;
}

} // namespace busbar::backend
