#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <busbar/server/memory_source.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "require.hpp"
#include "support/server_fixture.hpp"

/// A server whose limits are small and clients that subscribe to it, for a script that does
/// anything; what comes out is checked.
namespace busbar::fuzz {

/// Everybody is let in, by the name that he has.
class AnyUser final : public server::UserStore {
public:
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view name,
                                                      std::string_view) override
    {
        server::UserIdentity user{UserTokenType::UserName, std::string{name}};
        user.valid_until = valid_until;
        return user;
    }

    DateTime valid_until{};
};

/// One user may read nothing, and who that is changes.
class AllButOne final : public server::AccessControl {
public:
    [[nodiscard]] bool may_browse(const server::UserIdentity& user, const NodeId&) const override
    {
        return user.name != blind;
    }
    [[nodiscard]] std::uint8_t user_access_level(const server::UserIdentity& user, const NodeId&,
                                                 std::uint8_t access_level) const override
    {
        return user.name != shut_out ? access_level : std::uint8_t{0};
    }

    std::string blind;
    std::string shut_out;
};

class SubscriptionWorld {
public:
    static constexpr std::size_t client_count = 3;
    static constexpr std::size_t variable_count = 3;

    SubscriptionWorld();
    /// All as it was at first, with clients that have just logged in.
    void begin();
    /// Ends all sessions and lets the time pass; requires that nothing is left.
    void finish();

    [[nodiscard]] test::TestClient& client(std::size_t index) { return *clients_[index]; }
    [[nodiscard]] model::AddressSpace& space() { return server_.address_space(); }
    [[nodiscard]] server::Server& server() { return server_; }
    [[nodiscard]] NodeId variable(std::size_t index) const;
    void set(std::size_t variable, Variant value, StatusCode status)
    {
        memory_.set(handles_[variable], std::move(value), status);
    }
    void log_in(std::size_t index, std::string_view user);
    /// The connection dies; the session stays until it expires.
    void reconnect(std::size_t index, std::string_view user);
    void advance(Duration time);

    /// Looks at all that has come, and at what the server tells of itself.
    void check();
    /// Ids of this input, in the order in which they were given, behind 0.
    std::vector<std::uint32_t> subscriptions;
    std::vector<std::uint32_t> items;

    AnyUser users;
    AllButOne access;
    test::FixedWallClock wall_clock;
    TimePoint now{};

private:
    [[nodiscard]] static server::ServerConfig config();
    void add_variable(std::size_t index);
    void connect(std::size_t index);
    [[nodiscard]] bool is_busy() const;
    void check_message(const PublishResponse& response);
    void check_counts() const;

    test::SeededRandom random_;
    NullLog log_;
    server::MemorySource memory_{wall_clock};
    server::Server server_;
    std::array<std::uint64_t, variable_count> handles_{};
    std::array<std::optional<test::TestClient>, client_count> clients_;
    /// The last sequence number of each Subscription; none when a connection died with messages.
    std::map<std::uint32_t, std::uint32_t> sequence_;
    std::uint32_t source_{0};
};

} // namespace busbar::fuzz
