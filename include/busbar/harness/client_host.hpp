#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include <busbar/client/client.hpp>
#include <busbar/core/api.hpp>
#include <busbar/harness/connection_host.hpp>

namespace busbar::harness {

/// Returns the configuration for the server of open_server_config(): an anonymous user without
/// security.
[[nodiscard]] BUSBAR_API client::ClientConfig open_client_config();

/// Runs a client::Client in a world: gives it the connections that it orders, a new link for each,
/// and the time. One thread; the world must outlive it.
class BUSBAR_API ClientHost final : private LinkEnd {
public:
    explicit ClientHost(World& world, client::ClientConfig config = open_client_config(),
                        const ClientParts& parts = {});
    ~ClientHost() override;

    /// Requests that are made outside of a run begin with the next run.
    [[nodiscard]] client::Client& client()
    {
        touched_.raise();
        return *client_;
    }
    [[nodiscard]] client::ClientState state() const { return client_->state(); }
    /// Called after each of the Client's steps.
    void on_step(std::function<void()> handler) { on_step_ = std::move(handler); }

    /// Lets the Client connect and runs the world until it is Ready. The error is its last_error()
    /// if it gave up or `limit` has passed, Bad_Timeout if there is none.
    Result<void> connect(Duration limit = std::chrono::minutes{1});
    /// Closes it properly and runs the world until that is done.
    void close(Duration limit = std::chrono::minutes{1});
    /// Sends a request and runs the world until its response arrives; Bad_Timeout if `limit` is
    /// over first. Must not be called within a handler.
    template <typename Response, typename Request>
    [[nodiscard]] Result<Response> call(Request request, Duration limit = std::chrono::minutes{1})
    {
        const auto answer = std::make_shared<std::optional<Result<Response>>>();
        client().template call<Response, Request>(
            std::move(request),
            [answer](Result<Response> response) { *answer = std::move(response); });
        if (!world_.run_until([&] { return answer->has_value(); }, limit)) {
            return fail(status::Bad_Timeout);
        }
        return std::move(**answer);
    }

private:
    // LinkEnd.
    [[nodiscard]] std::span<const std::byte> output() const override { return client_->output(); }
    void consume(std::size_t size) override { client_->consume(size); }
    void feed(std::span<const std::byte> in) override;
    void link_lost() override;

    void update();
    void obey(client::TransportOrder order);
    void open();

    World& world_;
    ClientParts parts_;
    SeededRandom random_;
    crypto::InsecureAcceptAnyCertificate accept_any_;
    channel::ChannelEnvironment environment_;
    std::unique_ptr<client::Client> client_;
    std::shared_ptr<Link> link_;
    client::TransportOrder order_;
    std::function<void()> on_step_;
    Alarm open_;
    Alarm deadline_;
    Signal touched_;
};

} // namespace busbar::harness
