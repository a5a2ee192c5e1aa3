#pragma once

#include <deque>
#include <utility>

#include <busbar/client/requester.hpp>

#include "support/server_fixture.hpp"

namespace busbar::test {

/// A Requester in a session with a server in the same process. Requests go out in run().
class ServerRequester final : public client::Requester {
public:
    explicit ServerRequester(TestClient client) : client_{std::move(client)} {}

    /// Until there is nothing more to send.
    void run()
    {
        while (!waiting_.empty()) {
            Waiting request = std::move(waiting_.front());
            waiting_.pop_front();
            request.handler(exchange(request.encode));
        }
    }

    void cancel(client::RequestId id) override
    {
        std::erase_if(waiting_, [&](const Waiting& request) { return request.id == id; });
    }
    [[nodiscard]] const client::ServerInfo& server() const override { return info; }
    [[nodiscard]] TimePoint now() const override { return {}; }
    [[nodiscard]] const binary::DecodeLimits& decode_limits() const override { return limits; }

    client::ServerInfo info{{"http://opcfoundation.org/UA/", "urn:busbar:test:server"}, {}, {}, 1};
    binary::DecodeLimits limits;

private:
    struct Waiting {
        client::RequestId id;
        Encode encode;
        Handler<client::ResponseBody> handler;
    };

    [[nodiscard]] Result<client::ResponseBody> exchange(const Encode& encode)
    {
        RequestHeader header;
        header.authentication_token = client_.authentication_token;
        header.request_handle = ++client_.last_handle;
        Result<void> encoded;
        const std::uint32_t id = client_.send_bytes([&](binary::Writer& writer) {
            encode(writer, header);
            encoded = writer.ok() ? Result<void>{} : fail(writer.status());
        });
        if (!encoded) {
            return fail(encoded.error());
        }
        client_.run();
        for (auto message = client_.messages.begin(); message != client_.messages.end();
             ++message) {
            if (message->request_id == id) {
                client::ResponseBody body{std::move(message->body)};
                client_.messages.erase(message);
                return with_service_result(std::move(body));
            }
        }
        return fail(status::Bad_ConnectionClosed);
    }
    [[nodiscard]] static Result<client::ResponseBody> with_service_result(client::ResponseBody body)
    {
        binary::Reader reader{body.bytes};
        NodeId id;
        ResponseHeader header;
        decode(reader, id);
        decode(reader, header);
        if (header.service_result.is_bad()) {
            return fail(header.service_result);
        }
        return body;
    }
    client::RequestId start(Encode encode, Handler<client::ResponseBody> handler,
                            const client::RequestOptions& /*options*/) override
    {
        waiting_.push_back({++last_id_, std::move(encode), std::move(handler)});
        return last_id_;
    }

    TestClient client_;
    std::deque<Waiting> waiting_;
    client::RequestId last_id_{0};
};

} // namespace busbar::test
