#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <busbar/harness/client_host.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/harness/server_host.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::harness {

/// What a FaultPlant is made of; the default survives an outage of half a minute without a Gap.
struct PlantOptions {
    bool is_secure{false};
    Duration session_timeout{std::chrono::seconds{40}};
    Duration subscription_lifetime{std::chrono::minutes{1}};
    crypto::CertificateValidator* validator{nullptr};
};

/// A server with a counter, and a Client that watches and reads it whatever goes wrong. Keeps
/// account of every value and every request; what is wrong with them is in complaints().
class FaultPlant {
public:
    explicit FaultPlant(PlantOptions options = {})
        : options_{std::move(options)}, client_{world, client_config(), client_parts()}
    {
        handle_ = memory_.add(std::int32_t{0});
        start_server(identity("server"));
        subscribe();
    }

    [[nodiscard]] static const channel::ApplicationIdentity& identity(const std::string& name)
    {
        static std::map<std::string, channel::ApplicationIdentity> made;
        auto found = made.find(name);
        if (found == made.end()) {
            IdentityOptions options;
            options.name = name;
            // However many servers there are, they are one application.
            options.application_uri =
                name == "client" ? "urn:busbar:harness:client" : "urn:busbar:harness:server";
            found = made.emplace(name, make_identity(options).value()).first;
        }
        return found->second;
    }

    void start_server(const channel::ApplicationIdentity& identity)
    {
        server::ServerConfig config = open_server_config();
        if (options_.is_secure) {
            config.identity = identity;
            config.endpoints[0].security = {crypto::find_policy_by_name("Basic256Sha256"),
                                            MessageSecurityMode::SignAndEncrypt};
        }
        server_ = std::make_unique<ServerHost>(world, std::move(config));
        model::NewVariable variable;
        variable.source = server_->add_source(memory_);
        variable.handle = handle_;
        variable.data_type = NodeId{0, id::Int32};
        model::NewNode node;
        node.id = counter;
        node.browse_name = QualifiedName{1, "Counter"};
        node.parent = server().address_space().find(id::ObjectsFolder);
        static_cast<void>(server().address_space().add_variable(node, variable));
    }
    void stop_server() { server_.reset(); }
    [[nodiscard]] server::Server& server() { return server_->server(); }
    [[nodiscard]] client::Client& client() { return client_.client(); }
    [[nodiscard]] client::ClientState state() const { return client_.state(); }

    /// Counts and reads from now on.
    void start()
    {
        client().connect(world.now());
        tick_.set_after(tick_interval);
        read_.set_after(read_interval);
    }
    /// No more values and requests; true if the last value arrives.
    [[nodiscard]] bool finish()
    {
        tick_.cancel();
        read_.cancel();
        return world.run_until([this] { return last_seen() == last_set(); },
                               std::chrono::seconds{2});
    }
    /// The newest value that was set, and that arrived.
    [[nodiscard]] std::int32_t last_set() const
    {
        return static_cast<std::int32_t>(set_at_.size());
    }
    [[nodiscard]] std::int32_t last_seen() const { return last_; }
    void close() { client_.close(); }
    [[nodiscard]] bool has_answers_to_all() const { return asked_ == answered_; }
    [[nodiscard]] std::size_t answers() const { return answered_; }
    [[nodiscard]] std::size_t errors() const { return errors_; }
    /// Neither more nor less than one client needs.
    [[nodiscard]] bool holds_one_of_each()
    {
        return server().session_count() == 1 && server().subscription_count() == 1 &&
               server().monitored_item_count() == 1;
    }
    [[nodiscard]] bool holds_nothing()
    {
        return server().session_count() == 0 && server().subscription_count() == 0 &&
               server().monitored_item_count() == 0 && server().connection_count() == 0;
    }
    [[nodiscard]] const std::string& complaints() const { return complaints_; }

    World world;
    NodeId counter{1, "Counter"};
    /// Of the whole run.
    std::vector<client::Gap> gaps;

private:
    static constexpr Duration tick_interval = std::chrono::milliseconds{110};
    static constexpr Duration read_interval = std::chrono::milliseconds{300};
    static constexpr Duration publishing_interval = std::chrono::milliseconds{100};
    static constexpr Duration sampling_interval = std::chrono::milliseconds{50};
    static constexpr Duration request_timeout = std::chrono::seconds{10};

    [[nodiscard]] client::ClientConfig client_config() const
    {
        client::ClientConfig config = open_client_config();
        config.session_timeout = options_.session_timeout;
        config.request_timeout = request_timeout;
        config.channel_lifetime = std::chrono::seconds{20};
        config.reconnect.longest = std::chrono::seconds{5};
        if (options_.is_secure) {
            config.security = {};
        }
        return config;
    }
    [[nodiscard]] ClientParts client_parts() const
    {
        ClientParts parts;
        parts.validator = options_.validator;
        parts.identity = options_.is_secure ? &identity("client") : nullptr;
        return parts;
    }

    void subscribe()
    {
        client::SubscriptionSettings settings;
        settings.publishing_interval = publishing_interval;
        settings.max_keep_alive_count = 10;
        settings.lifetime_count =
            static_cast<std::uint32_t>(options_.subscription_lifetime / publishing_interval);
        client::SubscriptionHandlers handlers;
        handlers.on_data = [this](std::span<const client::DataChange> changes) {
            for (const client::DataChange& change : changes) {
                take(change.value.value.value_or<std::int32_t>(-1));
            }
        };
        handlers.on_gap = [this](const client::Gap& gap) {
            gaps.push_back(gap);
            open_gaps_.push_back(gap);
        };
        const auto subscription =
            client().subscriptions().create(settings, std::move(handlers)).value();
        client::ItemSettings item;
        item.node = counter;
        item.sampling_interval = sampling_interval;
        item.queue_size = 1'000;
        static_cast<void>(client().subscriptions().add_items(subscription, {item}).value());
    }

    void tick()
    {
        set_at_.push_back(world.clock().now());
        memory_.set(handle_, last_set());
        tick_.set_after(tick_interval);
    }

    void read()
    {
        ReadRequest request;
        ReadValueId& item = request.nodes_to_read.emplace_back();
        item.node_id = counter;
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        ++asked_;
        client().call<ReadResponse>(std::move(request),
                                    [this, asked_at = world.now()](Result<ReadResponse> response) {
                                        answered(asked_at, response);
                                    });
        read_.set_after(read_interval);
    }
    void answered(TimePoint asked_at, const Result<ReadResponse>& response)
    {
        ++answered_;
        if (world.now() - asked_at > request_timeout) {
            complain("an answer came after the request's time");
        }
        if (!response) {
            ++errors_;
            return;
        }
        const auto value = response->results.size() == 1
                               ? response->results[0].value.value_or<std::int32_t>(-1)
                               : -1;
        if (value < 0 || value > last_set()) {
            complain("read " + std::to_string(value));
        }
    }

    /// Each value comes once and in order, or was set within a Gap.
    void take(std::int32_t value)
    {
        const std::int32_t newest = last_set();
        // A Subscription that was made anew begins with the value that is there.
        const bool is_initial = value == last_ && !open_gaps_.empty();
        if (value < 0 || value > newest || (value <= last_ && !is_initial)) {
            complain("value " + std::to_string(value) + " after " + std::to_string(last_));
        }
        for (std::int32_t lost = last_ + 1; last_ >= 0 && lost < std::min(value, newest); ++lost) {
            if (!lies_in_gap(lost)) {
                complain("value " + std::to_string(lost) + " is lost");
            }
        }
        open_gaps_.clear();
        last_ = value;
    }
    [[nodiscard]] bool lies_in_gap(std::int32_t value) const
    {
        if (value == 0) {
            return !open_gaps_.empty();
        }
        const DateTime time = set_at_.at(static_cast<std::size_t>(value - 1));
        // A value is published up to a sampling and a publishing interval after it was set.
        const auto late = (sampling_interval + publishing_interval).count() / 100;
        return std::any_of(open_gaps_.begin(), open_gaps_.end(), [&](const client::Gap& gap) {
            return time.ticks >= gap.from.ticks - late && time <= gap.to;
        });
    }
    void complain(const std::string& line)
    {
        if (complaints_.size() < 1'000) {
            complaints_ += line + "\n";
        }
    }

    PlantOptions options_;
    server::MemorySource memory_{world.clock()};
    std::uint64_t handle_{0};
    std::unique_ptr<ServerHost> server_;
    ClientHost client_;
    Alarm tick_{world.scheduler(), [this] { tick(); }};
    Alarm read_{world.scheduler(), [this] { read(); }};

    std::vector<DateTime> set_at_; // by value, from 1
    std::int32_t last_{-1};
    std::vector<client::Gap> open_gaps_; // since the last value
    std::size_t asked_{0};
    std::size_t answered_{0};
    std::size_t errors_{0};
    std::string complaints_;
};

} // namespace busbar::harness
