#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <busbar/channel/server_channel.hpp>
#include <busbar/core/api.hpp>
#include <busbar/harness/message_body.hpp>
#include <busbar/harness/seeded_random.hpp>
#include <busbar/harness/world.hpp>
#include <busbar/harness/wrong.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/session.hpp>

namespace busbar::harness {

/// The delay of a scripted peer: `reply(response, after(4ms))`.
struct After {
    Duration delay{0};
};
/// Lets an answer wait in virtual time.
[[nodiscard]] constexpr After after(Duration delay)
{
    return {delay};
}

namespace detail {

/// Answers that wait for the test.
struct Hold {
    bool is_open{false};
    /// Looks after the answers of each peer that has some.
    std::vector<std::function<void()>> waiting{};
};

/// One request that a scripted server waits for, and its reaction.
struct ScriptStep {
    using Matches = std::function<bool(std::span<const std::byte> request)>;
    using Answer = std::function<Result<std::vector<std::byte>>(std::span<const std::byte> request,
                                                                DateTime now, const Wrong& wrong)>;

    std::uint32_t encoding_id{0};
    std::string name;
    /// If null, every request of the type is the one.
    Matches matches;
    Duration delay{0};
    /// The body of the response; null if there is none.
    Answer answer;
    Wrong wrong;
    /// Null if it does not wait.
    std::shared_ptr<Hold> hold;
    /// The connection ends, with an Error message unless this is Good.
    std::optional<StatusCode> end;
};

template <typename T>
struct AsResult {
    using Type = Result<T>;
};
template <typename T>
struct AsResult<Result<T>> {
    using Type = Result<T>;
};
template <typename T>
using ResultOf = typename AsResult<T>::Type;

} // namespace detail

/// Answers that wait until the test lets them go: see Expectation::held(). May outlive its server.
class HeldAnswers {
public:
    /// Created by Expectation::held().
    explicit HeldAnswers(std::shared_ptr<detail::Hold> hold) : hold_{std::move(hold)} {}

    /// Sends those that wait; later ones do not wait.
    void let_go()
    {
        hold_->is_open = true;
        for (const auto& look : hold_->waiting) {
            look();
        }
        hold_->waiting.clear();
    }
    /// The number of answers that wait, those of lost connections among them.
    [[nodiscard]] std::size_t count() const { return hold_->waiting.size(); }

private:
    std::shared_ptr<detail::Hold> hold_;
};

/// The reaction of a scripted server to a Request; nothing, unless one of these is called. Must not
/// be used once its request has arrived, or the server has ended.
template <typename Request>
class Expectation {
public:
    explicit Expectation(detail::ScriptStep& step) : step_{&step} {}

    /// Answers with `response`, whose header gets the request's handle and, if it has none, the
    /// time; or with the result of a function of the request, a ServiceFault if that is a failed
    /// Result.
    template <typename Response>
    Expectation reply(Response response, After delay = {})
    {
        if constexpr (std::is_invocable_v<Response, const Request&>) {
            answer(std::move(response), delay);
        } else {
            answer([response = std::move(response)](const Request&) { return response; }, delay);
        }
        return *this;
    }
    /// Answers with a ServiceFault.
    Expectation fail(StatusCode status, After delay = {})
    {
        ServiceFault fault;
        fault.response_header.service_result = status;
        return reply(std::move(fault), delay);
    }
    /// Makes the answer depart from the protocol; replaces an earlier wrong() or twice().
    Expectation wrong(const Wrong& how)
    {
        step_->wrong = how;
        return *this;
    }
    /// The answer is sent twice.
    Expectation twice()
    {
        step_->wrong.copies = 2;
        return *this;
    }
    /// The answer, which is made when the request comes, waits until the test lets it go.
    HeldAnswers held()
    {
        step_->hold = std::make_shared<detail::Hold>();
        return HeldAnswers{step_->hold};
    }
    /// Sends an Error message and closes the connection.
    void close(StatusCode status, After delay = {})
    {
        step_->end = status;
        step_->delay = delay.delay;
    }
    /// Resets the connection.
    void cut(After delay = {}) { close(status::Good, delay); }

private:
    template <typename Make>
    void answer(Make make, After delay)
    {
        step_->delay = delay.delay;
        step_->answer =
            [make = std::move(make)](std::span<const std::byte> body, DateTime now,
                                     const Wrong& wrong) -> Result<std::vector<std::byte>> {
            const auto request = decode_body<Request>(body);
            if (!request) {
                return busbar::fail(request.error());
            }
            detail::ResultOf<decltype(make(*request))> made = make(*request);
            if (!made) {
                return busbar::fail(made.error());
            }
            auto& response = *made;
            response.response_header.request_handle =
                wrong.request_handle.value_or(request->request_header.request_handle);
            if (response.response_header.timestamp == DateTime{}) {
                response.response_header.timestamp = now;
            }
            return encode_body(response);
        };
    }

    detail::ScriptStep* step_;
};

/// Returns a condition for ScriptedServer::expect(): the request reads the Value of this node.
[[nodiscard]] BUSBAR_API std::function<bool(const ReadRequest&)> reads(const NodeId& node);

/// The parts that a scripted server needs for policies other than None. All pointers must outlive
/// the server.
struct ScriptedServerParts {
    std::vector<channel::SecuritySetting> allowed{{}};
    crypto::CertificateValidator* validator{nullptr};
    /// The certificate and private key with which the server secures its channels.
    const channel::ApplicationIdentity* identity{nullptr};
    /// The URI that endpoints and namespaces name; a client that checks wants the identity's.
    std::string application_uri{"urn:busbar:harness:server"};
};

/// A server that answers what a test wants, rightly or not. It handles the channel,
/// OpenSecureChannel and its renewals, by itself; services follow the script:
///
///     ScriptedServer server{world, "opc.tcp://server:4840"};
///     server.accept_clients();
///     server.expect<ReadRequest>(reads(NodeId{1, "Level"})).reply(response, after(4ms));
///     server.expect<WriteRequest>().reply(WriteResponse{}).wrong({.request_id = 4711});
///     auto publish = server.expect<PublishRequest>().reply(notification).held();
///
/// Requests must arrive in the order of the expectations, over any number of connections. Those out
/// of turn are answered with Bad_ServiceUnsupported and reported. If its report is not empty and
/// the test has not asked for report(), the test fails at the server's end (set_fail_test() in
/// report.hpp) unless forgive_report() was called; is_done() excuses the requests that have not
/// arrived, but not those out of turn. One thread; the world must outlive it.
class BUSBAR_API ScriptedServer final : public Acceptor {
public:
    ScriptedServer(World& world, std::string_view url, const ScriptedServerParts& parts = {});
    ~ScriptedServer() override;

    /// Adds a request that must arrive next, after those that were added before.
    template <typename Request>
    Expectation<Request> expect()
    {
        return Expectation<Request>{add(steps_.emplace_back(), Request::binary_encoding_id)};
    }
    /// The same for a request for which `matches` is true; another one of its type is out of turn.
    template <typename Request>
    Expectation<Request> expect(std::function<bool(const Request&)> matches)
    {
        return matching<Request>(steps_.emplace_back(), std::move(matches));
    }
    /// Adds a request that may arrive at any time and any number of times; considered after the
    /// next one that must arrive.
    template <typename Request>
    Expectation<Request> allow()
    {
        return Expectation<Request>{add(allowed_.emplace_back(), Request::binary_encoding_id)};
    }
    /// The same for a request for which `matches` is true.
    template <typename Request>
    Expectation<Request> allow(std::function<bool(const Request&)> matches)
    {
        return matching<Request>(allowed_.emplace_back(), std::move(matches));
    }
    /// Expects CreateSession and ActivateSession, of any user, and grants both.
    void accept_session();
    /// Allows what clients do by themselves, after what was and will be said: FindServers,
    /// GetEndpoints, sessions of any user, CloseSession, and Reads of nodes of namespace 0, of
    /// which there are ServerStatus, its State, NamespaceArray and ServerArray.
    void accept_clients();

    /// The answer to a request that is neither expected nor allowed.
    struct OtherAnswer {
        /// The body of a response, with the header that it shall have; empty for no answer.
        std::vector<std::byte> body;
        /// The time until it is sent.
        Duration delay{0};
    };
    /// Returns the answer; nothing for a request that is out of turn.
    using AnswerOthers =
        std::function<std::optional<OtherAnswer>(std::span<const std::byte> request)>;
    /// Asks `answer` about requests that are neither expected nor allowed, before what
    /// accept_clients() allows.
    void answer_others(AnswerOthers answer) { others_ = std::move(answer); }

    /// Sends a response, asked for or not, to the newest client; its header's handle is as it is.
    /// Bad_NotConnected without a channel.
    template <typename Response>
    Result<void> send(const Response& response, std::uint32_t request_id, const Wrong& wrong = {})
    {
        const auto body = encode_body(response);
        return body ? send_body(request_id, *body, wrong) : fail(body.error());
    }
    /// Sends bytes past the channel to the newest client, whole chunks or anything else.
    void send_bytes(std::span<const std::byte> bytes);
    /// Sends these bytes, which may be none, instead of its next "ACK", "OPN", "MSG" or "ERR".
    void replace(std::string_view message_type, std::vector<std::byte> bytes);

    /// Returns whether all expected requests have arrived.
    [[nodiscard]] bool is_done() const
    {
        excuses_steps_ = true;
        return steps_.empty();
    }
    /// The expected requests that did not arrive, and the unexpected ones that did; one a line,
    /// empty if everything followed the script. At most 100 lines for unexpected ones.
    [[nodiscard]] std::string report() const;
    /// From now on the server may end without a look at its report(): it has requests that are not
    /// in its script, or some of its script may not come.
    void forgive_report() { excuses_all_ = true; }
    /// Names of all requests that arrived, in their order, the first 10,000.
    [[nodiscard]] const std::vector<std::string>& came() const { return came_; }

    /// The channel of the present request; only for functions that create its response.
    [[nodiscard]] const channel::ServerChannel& channel() const { return *channel_; }

    [[nodiscard]] bool accept(const std::shared_ptr<Link>& link,
                              std::string_view peer_address) override;

private:
    class Peer;

    static detail::ScriptStep& add(detail::ScriptStep& step, std::uint32_t encoding_id);
    template <typename Request>
    static Expectation<Request> matching(detail::ScriptStep& step,
                                         std::function<bool(const Request&)> matches)
    {
        step.matches = [matches = std::move(matches)](std::span<const std::byte> body) {
            const auto request = decode_body<Request>(body);
            return request && matches(*request);
        };
        return Expectation<Request>{add(step, Request::binary_encoding_id)};
    }
    template <typename Request, typename Make>
    void by_itself(Make make, std::function<bool(const Request&)> matches = nullptr)
    {
        detail::ScriptStep& step = defaults_.emplace_back();
        if (matches) {
            matching<Request>(step, std::move(matches)).reply(std::move(make));
        } else {
            Expectation<Request>{add(step, Request::binary_encoding_id)}.reply(std::move(make));
        }
    }
    /// Returns the part of report() that the test has not looked at.
    [[nodiscard]] std::string unseen_report() const;
    /// Returns a line for each expected request that has not arrived.
    [[nodiscard]] std::string missing() const;
    /// Returns a line for each request that was out of turn.
    [[nodiscard]] std::string unexpected() const;
    /// The newest connection; null if it has ended.
    [[nodiscard]] Peer* newest() const;
    Result<void> send_body(std::uint32_t request_id, std::span<const std::byte> body,
                           const Wrong& wrong);
    /// Returns what shall be sent instead of the next message of this type; nothing if it is right.
    [[nodiscard]] std::optional<std::vector<std::byte>>
    take_replaced(std::string_view message_type);
    [[nodiscard]] std::vector<EndpointDescription> endpoints(const String& url) const;
    [[nodiscard]] Result<CreateSessionResponse> create_session(const CreateSessionRequest& request);
    [[nodiscard]] ActivateSessionResponse activate_session();
    [[nodiscard]] ReadResponse read_own(const ReadRequest& request) const;
    /// Returns the reaction to a request; nothing if it is out of turn.
    [[nodiscard]] std::optional<detail::ScriptStep> take_step(std::span<const std::byte> body);

    World& world_;
    std::string url_;
    ScriptedServerParts parts_;
    LogSink& log_;
    SeededRandom random_;
    crypto::InsecureAcceptAnyCertificate accept_any_;
    std::deque<detail::ScriptStep> steps_;
    std::deque<detail::ScriptStep> allowed_;
    /// Considered last.
    std::deque<detail::ScriptStep> defaults_;
    AnswerOthers others_;
    std::vector<std::pair<std::string, std::vector<std::byte>>> replaced_;
    std::vector<std::string> came_;
    std::vector<std::string> unexpected_;
    std::vector<std::unique_ptr<Peer>> peers_;
    std::uint32_t last_channel_id_{0};
    std::uint32_t last_session_{0};
    const channel::ServerChannel* channel_{nullptr};
    /// The test has looked at report(), or does not mind what it says.
    mutable bool excuses_all_{false};
    /// The test has looked whether its script came to an end.
    mutable bool excuses_steps_{false};
};

} // namespace busbar::harness
