#pragma once

#include <optional>
#include <vector>

#include <busbar/busbar.h>
#include <busbar/core/function_ref.hpp>
#include <busbar/net/blocking_client.hpp>

#include "guard.hpp"
#include "surroundings.hpp"
#include "value.hpp"

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
    std::optional<busbar::net::BlockingClient> client;
};

namespace busbar::c {

/// Runs the body of a function for a client that works; null and one that could not be created have
/// their statuses.
[[nodiscard]] busbar_status enter(busbar_client* client, FunctionRef<StatusCode()> body) noexcept;

} // namespace busbar::c
