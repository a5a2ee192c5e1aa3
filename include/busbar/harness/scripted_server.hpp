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

/// One request that a scripted server waits for, and its reaction.
struct ScriptStep {
    using Answer = std::function<Result<std::vector<std::byte>>(std::span<const std::byte> request,
                                                                DateTime now)>;

    std::uint32_t encoding_id{0};
    std::string name;
    Duration delay{0};
    /// The body of the response; null if there is none.
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

/// The reaction of a scripted server to a Request; nothing, unless one of these is called.
template <typename Request>
class Expectation {
public:
    explicit Expectation(detail::ScriptStep& step) : step_{&step} {}

    /// Answers with `response`, whose header gets the request's handle and, if it has none, the
    /// time; or with the result of a function of the request, a ServiceFault if that is a failed
    /// Result.
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

/// The parts that a scripted server needs for policies other than None. All pointers must outlive
/// the server.
struct ScriptedServerParts {
    std::vector<channel::SecuritySetting> allowed{{}};
    crypto::CertificateValidator* validator{nullptr};
    const channel::ApplicationIdentity* identity{nullptr};
};

/// A server that answers what a test wants. It handles the channel, OpenSecureChannel and its
/// renewals, by itself; services follow the script:
///
///     ScriptedServer server{world, "opc.tcp://server:4840"};
///     server.accept_session();
///     server.expect<ReadRequest>().reply(response, after(4ms));
///
/// Requests must arrive in the order of the expectations, over any number of connections. Those out
/// of turn are answered with Bad_ServiceUnsupported and reported. One thread; the world must
/// outlive it.
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
    /// Adds a request that may arrive at any time and any number of times; considered after the
    /// next one that must arrive.
    template <typename Request>
    Expectation<Request> allow()
    {
        return Expectation<Request>{add(allowed_.emplace_back(), Request::binary_encoding_id)};
    }
    /// Expects CreateSession and ActivateSession, as an anonymous client without security sends
    /// them, and grants both.
    void accept_session();

    [[nodiscard]] bool is_done() const { return steps_.empty(); }
    /// The expected requests that did not arrive, and the unexpected ones that did; one a line,
    /// empty if everything followed the script. At most 100 lines for unexpected ones.
    [[nodiscard]] std::string report() const;
    /// Names of all requests that arrived, in their order, the first 10,000.
    [[nodiscard]] const std::vector<std::string>& came() const { return came_; }

    /// The channel of the present request; only for functions that create its response.
    [[nodiscard]] const channel::ServerChannel& channel() const { return *channel_; }

    [[nodiscard]] bool accept(const std::shared_ptr<Link>& link,
                              std::string_view peer_address) override;

private:
    class Peer;

    static detail::ScriptStep& add(detail::ScriptStep& step, std::uint32_t encoding_id);
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
    std::vector<std::string> came_;
    std::vector<std::string> unexpected_;
    std::vector<std::unique_ptr<Peer>> peers_;
    std::uint32_t last_channel_id_{0};
    const channel::ServerChannel* channel_{nullptr};
};

} // namespace busbar::harness
