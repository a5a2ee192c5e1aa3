#include <busbar/backend/slmp_client.hpp>

#include <algorithm>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include <busbar/core/status_codes.hpp>

#include "frame_queue.hpp"

namespace busbar::backend {

namespace {

constexpr const char* unknown_response =
    "the PLC sent a response that does not belong to the request under way";

/// A request from send() to its answer.
struct SlmpRequest {
    std::uint64_t id{0};
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
    explicit Impl(SlmpClientOptions given) : options{given}
    {
        if (options.frame == SlmpFrame::Frame3E || options.max_under_way == 0) {
            options.max_under_way = 1;
        }
    }

    [[nodiscard]] bool has_serial() const { return options.frame == SlmpFrame::Frame4E; }
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
    void close(StatusCode status, std::string reason);

    SlmpClientOptions options;
    std::deque<SlmpRequest> waiting{};
    std::vector<SlmpRequest> under_way{};
    detail::SlmpFrameQueue output{};
    std::vector<std::byte> input{};
    std::deque<SlmpEvent> events{};
    std::uint64_t last_id{0};
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
    while (!waiting.empty() && under_way.size() < options.max_under_way) {
        SlmpRequest& request = waiting.front();
        output.push(std::move(request.frame));
        request.sent = now;
        request.deadline = now + request.timeout;
        under_way.push_back(std::move(request));
        waiting.pop_front();
        ++counters.requests;
    }
}

std::vector<SlmpRequest>::iterator SlmpClient::Impl::find_request(const SlmpHead& head)
{
    if (!head.is_response || head.frame != options.frame || head.station != options.station) {
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
        if (!has_serial() && !options.is_datagram) {
            close(status::Bad_UnknownResponse, unknown_response);
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
}

void SlmpClient::Impl::refuse_frame(std::vector<SlmpRequest>::iterator request)
{
    if (has_serial()) {
        end(request, status::Bad_DecodingError, {}, {});
        return;
    }
    // It may be the answer to an earlier request, and the next one the answer to this.
    ++counters.unexpected;
    if (!options.is_datagram) {
        close(status::Bad_UnknownResponse, unknown_response);
    }
}

void SlmpClient::Impl::take_stream(std::span<const std::byte> in, TimePoint now)
{
    input.insert(input.end(), in.begin(), in.end());
    std::span<const std::byte> rest{input};
    while (!closed) {
        const auto head = read_slmp_head(rest);
        if (!head) {
            close(status::Bad_CommunicationError, "the PLC sent bytes that are not SLMP");
            break;
        }
        if (*head && (*head)->size > options.max_response) {
            close(status::Bad_ResponseTooLarge,
                  "the PLC sent a response of " + std::to_string((*head)->size) +
                      " bytes, more than the limit of " + std::to_string(options.max_response));
            break;
        }
        if (!*head || rest.size() < (*head)->size) {
            break;
        }
        take_frame(**head, rest.first((*head)->size), now);
        rest = rest.subspan((*head)->size);
    }
    input.erase(input.begin(), input.end() - static_cast<std::ptrdiff_t>(rest.size()));
    // Not before: what is in the input already cannot answer a request that is not sent yet.
    start_waiting(now);
}

void SlmpClient::Impl::take_datagram(std::span<const std::byte> in, TimePoint now)
{
    const auto head = read_slmp_head(in);
    if (head && *head && (*head)->size == in.size() && in.size() <= options.max_response) {
        take_frame(**head, in, now);
        start_waiting(now);
    } else {
        ++counters.unexpected;
    }
}

void SlmpClient::Impl::end(std::vector<SlmpRequest>::iterator request, StatusCode status,
                           SlmpAnswer answer, Duration round_trip)
{
    SlmpEvent event;
    event.id = request->id;
    event.status = status;
    event.answer = std::move(answer);
    event.round_trip = round_trip;
    events.push_back(std::move(event));
    under_way.erase(request);
}

void SlmpClient::Impl::close(StatusCode status, std::string reason)
{
    if (closed) {
        return;
    }
    closed = status;
    while (!under_way.empty()) {
        const bool is_reset = under_way.front().operation.command == SlmpCommand::RemoteReset;
        const bool is_by_peer = status == StatusCode{status::Bad_ConnectionClosed};
        end(under_way.begin(), is_reset && is_by_peer ? StatusCode{} : status, {}, {});
    }
    for (const SlmpRequest& request : waiting) {
        SlmpEvent event;
        event.id = request.id;
        event.status = status;
        events.push_back(std::move(event));
    }
    waiting.clear();
    output.clear();
    SlmpEvent last;
    last.kind = SlmpEvent::Kind::Closed;
    last.status = status;
    last.reason = std::move(reason);
    events.push_back(std::move(last));
}

SlmpClient::SlmpClient(SlmpClientOptions options) : impl_{std::make_unique<Impl>(options)} {}

SlmpClient::SlmpClient(SlmpClient&&) noexcept = default;
SlmpClient& SlmpClient::operator=(SlmpClient&&) noexcept = default;
SlmpClient::~SlmpClient() = default;

Result<std::uint64_t> SlmpClient::send(SlmpOperation operation, TimePoint now, Duration timeout)
{
    if (impl_->closed) {
        return fail(status::Bad_ConnectionClosed);
    }
    if (impl_->waiting.size() + impl_->under_way.size() >= impl_->options.max_requests) {
        return fail(status::Bad_TooManyOperations);
    }
    SlmpHead head{.frame = impl_->options.frame, .station = impl_->options.station};
    head.serial = impl_->has_serial() ? impl_->free_serial() : std::uint16_t{0};
    auto frame = encode_slmp_request(head, impl_->options.timer, operation);
    if (!frame) {
        return fail(frame.error());
    }
    SlmpRequest request;
    request.id = ++impl_->last_id;
    request.serial = head.serial;
    request.operation = std::move(operation);
    request.timeout = timeout > Duration{0} ? timeout : impl_->options.timeout;
    request.frame = std::move(*frame);
    impl_->waiting.push_back(std::move(request));
    impl_->start_waiting(now);
    return impl_->last_id;
}

Result<void> SlmpClient::feed(std::span<const std::byte> in, TimePoint now)
{
    if (!impl_->closed) {
        if (impl_->options.is_datagram) {
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
    return impl_->output.front();
}

void SlmpClient::consume(std::size_t size)
{
    impl_->output.consume(size);
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
    const bool is_lost = impl_->silent >= std::max<std::size_t>(impl_->options.max_silent, 1) ||
                         (impl_->silent > 0 && !impl_->has_serial());
    if (is_lost) {
        impl_->close(status::Bad_Timeout, "the PLC left " + std::to_string(impl_->silent) +
                                              " requests without an answer");
    } else {
        impl_->start_waiting(now);
    }
}

void SlmpClient::close(StatusCode status, std::string reason)
{
    impl_->close(status.is_bad() ? status : StatusCode{status::Bad_ConnectionClosed},
                 std::move(reason));
}

bool SlmpClient::is_closed() const
{
    return impl_->closed.has_value();
}

std::size_t SlmpClient::under_way() const
{
    return impl_->under_way.size();
}

const SlmpClientCounters& SlmpClient::counters() const
{
    return impl_->counters;
}

} // namespace busbar::backend
