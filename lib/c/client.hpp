#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <busbar/busbar.h>
#include <busbar/core/function_ref.hpp>
#include <busbar/net/blocking_client.hpp>

#include "guard.hpp"
#include "surroundings.hpp"
#include "value.hpp"

namespace busbar::c {

/// Where the values of a Subscription go, until it has ended.
struct Feed {
    busbar_client* client;
    busbar_data_callback callback;
    void* context;
    bool has_ended{false};
};

} // namespace busbar::c

/// A client with all that it owns.
struct busbar_client {
    explicit busbar_client(const busbar_application& application) : around{application} {}

    busbar::c::FailureText failure;
    /// The reason why it could not be created, or Good.
    busbar::StatusCode created{busbar::status::Bad_InvalidState};
    busbar::c::ApplicationSurroundings around;
    busbar::channel::ChannelEnvironment environment;
    /// The memory that results of the last function point at.
    std::vector<busbar::DataValue> values;
    busbar::Array<busbar::Variant> outputs;
    std::vector<busbar_value> outputs_in_c;
    std::vector<busbar_reference> references;
    busbar::c::Scratch scratch;
    /// Of the Subscriptions, by their numbers.
    std::map<std::uint32_t, std::shared_ptr<busbar::c::Feed>> feeds;
    /// A callback runs: functions that wait are refused.
    bool is_in_callback{false};
    std::optional<busbar::net::BlockingClient> client;
};

namespace busbar::c {

/// Runs the body of a function for a client that works; null and one that could not be created have
/// their statuses.
[[nodiscard]] busbar_status enter(busbar_client* client, FunctionRef<StatusCode()> body) noexcept;

/// Runs likewise what waits; Bad_RequestInterrupted in a callback, which would wait for itself.
[[nodiscard]] busbar_status wait(busbar_client* client, FunctionRef<StatusCode()> body) noexcept;

/// Marks that a callback of the client runs, as long as the object lives.
class InCallback {
public:
    explicit InCallback(busbar_client& client)
        : client_{&client}, was_{std::exchange(client.is_in_callback, true)}
    {
    }
    InCallback(const InCallback&) = delete;
    InCallback& operator=(const InCallback&) = delete;
    ~InCallback() { client_->is_in_callback = was_; }

private:
    busbar_client* client_;
    bool was_;
};

} // namespace busbar::c
