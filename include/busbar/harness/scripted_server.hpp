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

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/channel/server_channel.hpp>
#include <busbar/core/api.hpp>
#include <busbar/harness/seeded_random.hpp>
#include <busbar/harness/world.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/registry.hpp>

namespace busbar::harness {

/// How long a scripted peer takes: `reply(response, after(4ms))`.
struct After {
    Duration delay{0};
};
[[nodiscard]] constexpr After after(Duration delay)
{
    return {delay};
}

namespace detail {

/// One request that a scripted server waits for, and what it does then.
struct ScriptStep {
    using Answer = std::function<Result<std::vector<std::byte>>(std::span<const std::byte> request,
                                                                DateTime now)>;

    std::uint32_t encoding_id{0};
    std::string name;
    Duration delay{0};
    /// The body of the response; null: there is none.
    Answer answer;
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

template <typename Structure>
[[nodiscard]] Result<Structure> decode_body(std::span<const std::byte> body)
{
    static const binary::TypeRegistry types{binary::namespace0_types()};
    binary::Reader reader{body, binary::Strings::Own, &types};
    NodeId id;
    Structure structure;
    decode(reader, id);
    decode(reader, structure);
    if (!id.is(Structure::binary_encoding_id) || !reader.ok()) {
        return fail(status::Bad_DecodingError);
    }
    return structure;
}

template <typename Structure>
[[nodiscard]] Result<std::vector<std::byte>> encode_body(const Structure& structure)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, NodeId{0, Structure::binary_encoding_id});
    encode(writer, structure);
    if (!writer.ok()) {
        return fail(writer.status());
    }
    return sink.take(writer.written());
}

} // namespace detail

/// What a scripted server does when a Request comes; nothing, unless one of these is called.
template <typename Request>
class Expectation {
public:
    explicit Expectation(detail::ScriptStep& step) : step_{&step} {}

    /// Answers with `response`, whose header gets the request's handle and, if it has none, the
    /// time; or with what a function makes of the request, a ServiceFault if that is a Result that
    /// failed.
    template <typename Response>
    void reply(Response response, After delay = {})
    {
        if constexpr (std::is_invocable_v<Response, const Request&>) {
            answer(std::move(response), delay);
        } else {
            answer([response = std::move(response)](const Request&) { return response; }, delay);
        }
    }
    /// Answers with a ServiceFault.
    void fail(StatusCode status, After delay = {})
    {
        ServiceFault fault;
        fault.response_header.service_result = status;
        reply(std::move(fault), delay);
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
        step_->answer = [make = std::move(make)](std::span<const std::byte> body,
                                                 DateTime now) -> Result<std::vector<std::byte>> {
            const auto request = detail::decode_body<Request>(body);
            if (!request) {
                return busbar::fail(request.error());
            }
            detail::ResultOf<decltype(make(*request))> made = make(*request);
            if (!made) {
                return busbar::fail(made.error());
            }
            auto& response = *made;
            response.response_header.request_handle = request->request_header.request_handle;
            if (response.response_header.timestamp == DateTime{}) {
                response.response_header.timestamp = now;
            }
            return detail::encode_body(response);
        };
    }

    detail::ScriptStep* step_;
};

/// What a scripted server needs for policies other than None. All of it must outlive the server.
struct ScriptedServerParts {
    std::vector<channel::SecuritySetting> allowed{{}};
    crypto::CertificateValidator* validator{nullptr};
    const channel::ApplicationIdentity* identity{nullptr};
};

/// A server that says what a test wants. The channel's part, OpenSecureChannel and its renewals, it
/// does by itself; services are what was written down:
///
///     ScriptedServer server{world, "opc.tcp://server:4840"};
///     server.accept_session();
///     server.expect<ReadRequest>().reply(response, after(4ms));
///
/// Requests have to come in the order of the expectations, over however many connections. What
/// comes out of turn is answered with Bad_ServiceUnsupported and reported. One thread; the world
/// must outlive it.
class BUSBAR_API ScriptedServer final : public Acceptor {
public:
    ScriptedServer(World& world, std::string_view url, const ScriptedServerParts& parts = {});
    ~ScriptedServer() override;

    /// The next request that has to come, after those that were named before.
    template <typename Request>
    Expectation<Request> expect()
    {
        return Expectation<Request>{add(steps_.emplace_back(), Request::binary_encoding_id)};
    }
    /// A request that may come at any time and any number of times; considered after the next one
    /// that has to come.
    template <typename Request>
    Expectation<Request> allow()
    {
        return Expectation<Request>{add(allowed_.emplace_back(), Request::binary_encoding_id)};
    }
    /// Expects CreateSession and ActivateSession, as an anonymous client without security sends
    /// them, and grants both.
    void accept_session();

    [[nodiscard]] bool is_done() const { return steps_.empty(); }
    /// What was expected and did not come, and what came unexpectedly; one a line, empty if
    /// everything went by the script. At most 100 lines for what came.
    [[nodiscard]] std::string report() const;
    /// Names of all requests that came, in their order, the first 10,000.
    [[nodiscard]] const std::vector<std::string>& came() const { return came_; }

    /// The channel that a request came through; only for functions that make its response.
    [[nodiscard]] const channel::ServerChannel& channel() const { return *channel_; }

    [[nodiscard]] bool accept(const std::shared_ptr<Link>& link,
                              std::string_view peer_address) override;

private:
    class Peer;

    static detail::ScriptStep& add(detail::ScriptStep& step, std::uint32_t encoding_id);
    /// What is to be done about a request; nothing is known of it if it is out of turn.
    [[nodiscard]] std::optional<detail::ScriptStep> take_step(std::span<const std::byte> body);

    World& world_;
    std::string url_;
    ScriptedServerParts parts_;
    SeededRandom random_;
    crypto::InsecureAcceptAnyCertificate accept_any_;
    std::deque<detail::ScriptStep> steps_;
    std::deque<detail::ScriptStep> allowed_;
    std::vector<std::string> came_;
    std::vector<std::string> unexpected_;
    std::vector<std::unique_ptr<Peer>> peers_;
    std::uint32_t last_channel_id_{0};
    const channel::ServerChannel* channel_{nullptr};
};

} // namespace busbar::harness
