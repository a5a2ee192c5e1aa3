#pragma once

#include <deque>
#include <map>

#include <busbar/client/requester.hpp>

namespace busbar::test {

/// What tests' Requesters have in common: requests are kept until somebody has their answers, and
/// handlers are called by run() only.
class TestRequester : public client::Requester {
public:
    void cancel(client::RequestId id) override { requests_.erase(id); }
    [[nodiscard]] const client::ServerInfo& server() const override { return info; }
    [[nodiscard]] TimePoint now() const override { return time; }
    [[nodiscard]] const binary::DecodeLimits& decode_limits() const override { return limits_; }

    /// Calls the handlers of what was answered; true if there was anything.
    bool run()
    {
        auto answers = std::exchange(answers_, {});
        for (auto& [id, body] : answers) {
            const auto found = requests_.find(id);
            if (found != requests_.end()) {
                const auto handler = std::move(found->second.handler);
                requests_.erase(found);
                handler(std::move(body));
            }
        }
        return !answers.empty();
    }
    /// Answers what has waited for too long.
    void expire()
    {
        for (const auto& [id, request] : requests_) {
            if (request.deadline <= time) {
                answers_.push_back({id, fail(status::Bad_Timeout)});
            }
        }
    }
    void forget() { answers_.clear(); }
    [[nodiscard]] std::size_t open_count() const { return requests_.size(); }

    client::ServerInfo info;
    TimePoint time{};

protected:
    void answer(client::RequestId id, Result<client::ResponseBody> body)
    {
        answers_.push_back({id, std::move(body)});
    }
    virtual void sent(client::RequestId id, const Encode& encode) = 0;

private:
    struct Open {
        Handler<client::ResponseBody> handler;
        TimePoint deadline;
    };

    client::RequestId start(Encode encode, Handler<client::ResponseBody> handler,
                            const client::RequestOptions& options) override
    {
        const client::RequestId id = ++last_id_;
        const Duration timeout =
            options.timeout == Duration{0} ? std::chrono::seconds{10} : options.timeout;
        requests_.emplace(id, Open{std::move(handler), time + timeout});
        sent(id, encode);
        return id;
    }

    binary::DecodeLimits limits_;
    client::RequestId last_id_{0};
    std::map<client::RequestId, Open> requests_;
    std::deque<std::pair<client::RequestId, Result<client::ResponseBody>>> answers_;
};

} // namespace busbar::test
