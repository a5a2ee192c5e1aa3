#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <busbar/client/requester.hpp>

namespace busbar::test {

/// A Requester whose server is the test: a function for each kind of request. Requests wait until
/// step() or run(), so that nothing is answered from within a call.
class ScriptedRequester final : public client::Requester {
public:
    /// How requests of that type are answered from now on; others are Bad_ServiceUnsupported.
    template <typename Request, typename Response>
    void on(std::function<Result<Response>(const Request&)> answer)
    {
        answers_[Request::binary_encoding_id] =
            [answer = std::move(answer)](binary::Reader& reader) -> Result<client::ResponseBody> {
            Request request;
            decode(reader, request);
            if (!reader.ok()) {
                return fail(status::Bad_DecodingError);
            }
            const Result<Response> response = answer(request);
            if (!response) {
                return fail(response.error());
            }
            binary::VectorSink sink;
            binary::Writer writer{sink};
            encode(writer, NodeId{0, Response::binary_encoding_id});
            encode(writer, *response);
            return client::ResponseBody{sink.take(writer.written())};
        };
    }

    /// Answers the oldest request; false if there is none.
    bool step()
    {
        if (waiting_.empty()) {
            return false;
        }
        Waiting request = std::move(waiting_.front());
        waiting_.pop_front();
        request.handler(answer(request));
        return true;
    }
    /// Answers all there is and what comes of it; false if that does not end.
    bool run(int max_steps = 100'000)
    {
        while (max_steps > 0 && step()) {
            --max_steps;
        }
        return max_steps > 0;
    }
    [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
    [[nodiscard]] int sent() const { return sent_; }

    void cancel(client::RequestId id) override
    {
        std::erase_if(waiting_, [&](const Waiting& request) { return request.id == id; });
    }
    [[nodiscard]] const client::ServerInfo& server() const override { return info; }
    [[nodiscard]] TimePoint now() const override { return {}; }
    [[nodiscard]] const binary::DecodeLimits& decode_limits() const override { return limits; }

    client::ServerInfo info{{"http://opcfoundation.org/UA/", "urn:server", "urn:acme"}, {}, {}, 1};
    binary::DecodeLimits limits;

private:
    struct Waiting {
        client::RequestId id;
        Result<std::vector<std::byte>> bytes;
        Handler<client::ResponseBody> handler;
    };

    [[nodiscard]] Result<client::ResponseBody> answer(const Waiting& request)
    {
        if (!request.bytes) {
            return fail(request.bytes.error());
        }
        binary::Reader reader{*request.bytes, binary::Strings::Own, &client::standard_types()};
        NodeId id;
        decode(reader, id);
        const auto found = answers_.find(id.numeric());
        return found == answers_.end() ? fail(status::Bad_ServiceUnsupported)
                                       : found->second(reader);
    }
    client::RequestId start(Encode encode, Handler<client::ResponseBody> handler,
                            const client::RequestOptions& /*options*/) override
    {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        encode(writer, RequestHeader{});
        const auto id = static_cast<client::RequestId>(++last_id_);
        if (writer.ok()) {
            ++sent_;
            waiting_.push_back({id, sink.take(writer.written()), std::move(handler)});
        } else {
            waiting_.push_back({id, fail(writer.status()), std::move(handler)});
        }
        return id;
    }

    using Answer = std::function<Result<client::ResponseBody>(binary::Reader&)>;

    std::map<std::uint32_t, Answer> answers_;
    std::deque<Waiting> waiting_;
    int last_id_{0};
    int sent_{0};
};

} // namespace busbar::test
