#include <catch2/catch.hpp>

#include "client/request_queue.hpp"

namespace request_queue_test {

using namespace busbar;
using client::RequestId;
using client::ResponseBody;
using client::detail::RequestQueue;

namespace {

TimePoint at(int seconds)
{
    return TimePoint{} + std::chrono::seconds{seconds};
}

class NoLog final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view) override {}
};

struct Queue {
    RequestId add(int timeout_s, bool waits_for_session = true, bool is_closed = false)
    {
        const RequestId id = last + 1;
        last = queue.add([](binary::Writer&, const RequestHeader&) {},
                         [this, id](const Result<ResponseBody>& body) {
                             ended.emplace_back(id, body ? StatusCode{} : body.error());
                         },
                         {std::chrono::seconds{timeout_s}, waits_for_session}, false, is_closed);
        return last;
    }
    using Ended = std::vector<std::pair<RequestId, StatusCode>>;
    Ended deliver_all()
    {
        while (queue.deliver(log)) {
        }
        return std::exchange(ended, {});
    }

    RequestQueue queue{4, std::chrono::seconds{10}};
    NoLog log;
    RequestId last{0};
    Ended ended;
};

} // namespace

TEST_CASE("a request that waits ends at its deadline", "[request_queue]")
{
    Queue q;
    CHECK(q.queue.next_deadline() == no_deadline);
    const RequestId slow = q.add(30);
    const RequestId usual = q.add(0);
    const RequestId quick = q.add(5);
    CHECK(q.queue.next_deadline() == TimePoint::min()); // the time is not known yet
    CHECK_FALSE(q.queue.expire(at(100)));
    q.queue.tell(at(100));
    CHECK(q.queue.next_deadline() == at(105));
    CHECK_FALSE(q.queue.expire(at(104)));
    CHECK(q.queue.expire(at(110)));
    CHECK(q.queue.expire(at(110)));
    CHECK_FALSE(q.queue.expire(at(110)));
    CHECK(q.queue.next_deadline() == at(130));
    CHECK(q.deliver_all() ==
          Queue::Ended{{quick, status::Bad_Timeout}, {usual, status::Bad_Timeout}});
    CHECK(q.queue.has_waiting());
    CHECK_FALSE(q.queue.cancel(slow)); // it is under way nowhere
    CHECK_FALSE(q.queue.has_waiting());
    CHECK(q.queue.next_deadline() == no_deadline);
    CHECK(q.queue.size() == 0);
    CHECK(q.deliver_all().empty());
}

TEST_CASE("what cannot wait ends at once, and so does what is too much", "[request_queue]")
{
    Queue q;
    const RequestId impatient = q.add(1, false);
    const RequestId late = q.add(1, true, true);
    for (int i = 0; i < 4; ++i) {
        q.add(1);
    }
    const RequestId fifth = q.add(1);
    CHECK(q.deliver_all() == Queue::Ended{{impatient, status::Bad_ServerNotConnected},
                                          {late, status::Bad_ServerNotConnected},
                                          {fifth, status::Bad_TooManyOperations}});
    CHECK(q.queue.size() == 4);
    q.queue.end(status::Bad_ConnectionClosed, false);
    CHECK(q.deliver_all().empty()); // they wait for the next session
    q.queue.end(status::Bad_ServerNotConnected, true);
    CHECK(q.deliver_all().size() == 4);
    CHECK_FALSE(q.queue.has_waiting());
    CHECK(q.queue.size() == 0);
}

TEST_CASE("an answer to what was not sent is nothing", "[request_queue]")
{
    Queue q;
    const RequestId id = q.add(1);
    q.queue.answer(id, ResponseBody{});
    q.queue.answer(id + 1, ResponseBody{});
    q.queue.answer(0, ResponseBody{});
    CHECK_FALSE(q.queue.has_results());
    CHECK(q.queue.has_waiting());
}

} // namespace request_queue_test
