#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <busbar/client/type_cache.hpp>
#include <busbar/net/blocking_client.hpp>
#include <busbar/net/system.hpp>

#include "context.hpp"
#include "credentials.hpp"
#include "logs.hpp"
#include "tool/printing/value.hpp"

namespace busbar::tool {

/// A session with the server of the options. Ctrl+C ends whatever waits. Only one at a time.
class Connection {
public:
    /// Determines whether a lost session is created again.
    enum class Endurance : std::uint8_t { Short, Lasting };

    /// Connects; throws Failure.
    explicit Connection(Context& context, Endurance endurance = Endurance::Short);
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;
    ~Connection() { close(); }

    /// Ends the session; for good.
    void close();
    [[nodiscard]] net::BlockingClient& blocking() { return *client_; }
    [[nodiscard]] bool is_interrupted() const;
    /// Makes SIGHUP end waiting like Ctrl+C, unless the parent process ignores it.
    void end_at_hangup();
    [[nodiscard]] bool is_hung_up() const;
    [[nodiscard]] client::Client& client() { return client_->client(); }
    /// For connections of the caller's own, as long as this lives.
    [[nodiscard]] const channel::ChannelEnvironment& environment() const { return environment_; }
    [[nodiscard]] const client::UserIdentity& user() const { return user_; }
    [[nodiscard]] std::string application_uri() const { return credentials_.application_uri(); }

    /// The response; throws Failure, which says that `what` failed, or Interrupted.
    template <typename Response, typename Request>
    [[nodiscard]] Response call(Request request, const std::string& what)
    {
        return value(client_->call<Response>(std::move(request)), what);
    }
    /// Starts something that calls `done` with a T later, and waits for that. After Interrupted
    /// `done` may still be called, at the latest when the connection is closed.
    template <typename T, typename Start>
    [[nodiscard]] T wait_for(Start&& start)
    {
        const auto answer = std::make_shared<std::optional<T>>();
        start([answer](T result) { *answer = std::move(result); });
        wait_until([&answer] { return answer->has_value(); });
        return *std::move(*answer);
    }
    /// The types of the server's structures, those of `values` among them as far as the server
    /// describes them.
    /// `variables`, if there are any, are those that have the values.
    [[nodiscard]] Types types_of(const std::vector<DataValue>& values,
                                 const std::vector<NodeId>& variables = {});
    [[nodiscard]] Types types_of(const std::vector<NodeId>& data_types);
    /// The types learned from the server so far, with a source for more that does not wait.
    [[nodiscard]] client::TypeCache& types() { return *types_; }
    template <typename T>
    [[nodiscard]] T value(Result<T> result, const std::string& what) const
    {
        if (!result) {
            fail_with(result.error(), what);
        }
        return *std::move(result);
    }

private:
    void wait_until(const std::function<bool()>& is_done);
    [[noreturn]] void fail_with(StatusCode status, const std::string& what) const;
    /// Returns what this side refused, if that ended the connection; empty if it did not.
    [[nodiscard]] std::string own_refusal() const;
    [[noreturn]] void fail_to_connect(StatusCode status) const;
    [[nodiscard]] client::ClientConfig config(Endurance endurance);
    void connect(Endurance endurance);
    void warn_of_insecurity();

    Context* context_;
    VerboseLog log_;
    Credentials credentials_;
    std::unique_ptr<channel::KeyLog> key_log_;
    crypto::SystemRandom random_;
    net::SystemWallClock wall_clock_;
    channel::ChannelEnvironment environment_;
    client::UserIdentity user_;
    std::unique_ptr<net::BlockingClient> client_;
    std::optional<client::TypeCache> types_;
    bool is_closed_{false};
    mutable bool has_told_refusal_{false};
};

} // namespace busbar::tool
