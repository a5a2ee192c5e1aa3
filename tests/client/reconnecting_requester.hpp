#pragma once

#include <optional>

#include "support/server_fixture.hpp"
#include "test_requester.hpp"

namespace busbar::test {

/// Requests go to a real server, by a connection that tests cut.
class ReconnectingRequester final : public TestRequester {
public:
    explicit ReconnectingRequester(ServerFixture& fixture) : fixture_{fixture} {}

    void open_new()
    {
        time = fixture_.now;
        client_.emplace(fixture_.log_in(signed_channel_));
    }
    /// The session of the connection that was cut, on a new one.
    [[nodiscard]] StatusCode resume()
    {
        time = fixture_.now;
        TestClient next = fixture_.connect(signed_channel_);
        next.adopt(*last_);
        const StatusCode status = next.activate(next.user("operator", "operator-secret"));
        client_.emplace(std::move(next));
        last_.reset();
        return status;
    }
    /// What is under way to the client is lost.
    void cut()
    {
        last_ = std::move(client_);
        client_.reset();
        by_message_.clear();
        forget();
    }
    [[nodiscard]] bool is_open() const { return client_.has_value(); }
    [[nodiscard]] TestClient& client() { return *client_; }

    /// Takes what the server has sent.
    void receive()
    {
        if (!client_) {
            return;
        }
        client_->run();
        // The server's connection goes on where its turn ended.
        while (client_->connection.next_deadline() <= time) {
            client_->connection.handle_deadline(time);
            client_->run();
        }
        for (auto& message : std::exchange(client_->messages, {})) {
            const auto found = by_message_.find(message.request_id);
            if (found != by_message_.end()) {
                answer(found->second, checked(std::move(message.body)));
                by_message_.erase(found);
            }
        }
    }

private:
    void sent(client::RequestId id, const Encode& encode) override
    {
        if (!client_) {
            answer(id, fail(status::Bad_ServerNotConnected));
            return;
        }
        RequestHeader header;
        header.authentication_token = client_->authentication_token;
        header.request_handle = static_cast<std::uint32_t>(id);
        const auto message =
            client_->send_bytes([&](binary::Writer& writer) { encode(writer, header); });
        by_message_[message] = id;
    }
    /// The body, or the ServiceResult if that is bad.
    [[nodiscard]] static Result<client::ResponseBody> checked(std::vector<std::byte> body)
    {
        binary::Reader reader{body, binary::Strings::Borrow};
        NodeId id;
        ResponseHeader header;
        decode(reader, id);
        decode(reader, header);
        if (header.service_result.is_bad()) {
            return fail(header.service_result);
        }
        return client::ResponseBody{std::move(body)};
    }

    ServerFixture& fixture_;
    // Without signatures nobody gets the Subscriptions of another session (Part 4, 5.14.7).
    channel::SecuritySetting signed_channel_{setting("Basic256Sha256", MessageSecurityMode::Sign)};
    std::optional<TestClient> client_;
    std::optional<TestClient> last_;
    std::map<std::uint32_t, client::RequestId> by_message_;
};

} // namespace busbar::test
