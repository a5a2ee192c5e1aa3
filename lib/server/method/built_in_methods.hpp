#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <busbar/server/method.hpp>

#include "server/session/service.hpp"

namespace busbar::server::detail {

/// A Method of the Server object that the server carries out itself.
struct BuiltInMethod {
    std::uint32_t method_id;
    /// `inputs` are as the Method's InputArguments says; `item_count` is raised by the monitored
    /// items that had to be looked at.
    CallResult (*call)(ServiceContext& context, std::span<const Variant> inputs,
                       std::size_t& item_count);
};

/// Null if the server knows no such Method.
[[nodiscard]] const BuiltInMethod* find_built_in_method(const NodeId& method_id);

} // namespace busbar::server::detail
