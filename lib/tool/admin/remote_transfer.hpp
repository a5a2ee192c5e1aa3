#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "core/json.hpp"
#include "remote.hpp"

namespace busbar::tool::admin {

using busbar::detail::Json;
using busbar::detail::JsonLimits;

/// Exchanges temporary files with a server, by an Object of TemporaryFileTransferType (Part 20,
/// 4.4) below Objects. All functions throw Failure.
class RemoteTransfer {
public:
    using Progress = std::function<void(std::size_t done)>;

    /// If the server has no such Object, or hides it from this user, the Failure has `advice`.
    RemoteTransfer(Connection& connection, std::string name, const std::string& advice);

    /// Fetches the file that the server generates for these options.
    [[nodiscard]] std::string fetch(const Variant& options, const Progress& progress = {});
    /// Fetches a file that is a JSON document; null if it is not one, or longer than `max_size`.
    [[nodiscard]] Json answer(const char* options, std::size_t max_size = JsonLimits{}.max_size);
    /// Sends a file, which the server accepts as a whole or not at all; a Failure has the server's
    /// answer.
    void send(const Variant& options, std::string_view file, const Progress& progress = {});
    /// True if the server may have accepted the file although send() failed: it had all of it, and
    /// did not answer.
    [[nodiscard]] bool may_be_taken(const Failure& failure) const
    {
        return has_sent_all_ && failure.exit == Exit::NotConnected;
    }

private:
    /// Calls a Method and returns the outputs, at least `wanted` of them.
    std::vector<Variant> on(const NodeId& object, const char* method,
                            const std::vector<Variant>& inputs, std::size_t wanted);
    /// The same for a Method with a known NodeId.
    std::vector<Variant> on(const NodeId& object, const NodeId& method, const char* method_name,
                            const std::vector<Variant>& inputs, std::size_t wanted);
    void abandon(const NodeId& file, const Variant& handle);

    Connection& connection_;
    std::string name_;
    NodeId object_;
    bool has_sent_all_{false};
};

/// The text of a member; empty without one.
[[nodiscard]] std::string text_in(const Json& json, std::string_view name);
/// The elements of a member; none without one.
[[nodiscard]] std::span<const Json> items_in(const Json& json, std::string_view name);

} // namespace busbar::tool::admin
