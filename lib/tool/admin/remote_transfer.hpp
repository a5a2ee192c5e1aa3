#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "remote.hpp"

namespace busbar::tool::admin {

/// Files that a server makes for clients and takes from them, by an Object of
/// TemporaryFileTransferType (Part 20, 4.4) below Objects. All of it throws Failure.
class RemoteTransfer {
public:
    using Progress = std::function<void(std::size_t done)>;

    /// The failure has `advice` if the server has no such Object, or hides it from this user.
    RemoteTransfer(Connection& connection, std::string name, const std::string& advice);

    /// The file that the server makes for these options.
    [[nodiscard]] std::string fetch(const Variant& options, const Progress& progress = {});
    /// Has the server take a file as a whole, or not at all; the failure is the server's answer.
    void send(const Variant& options, std::string_view file, const Progress& progress = {});
    /// Whether the server may have taken the file although send() failed: it had all of it, and
    /// there was no answer.
    [[nodiscard]] bool may_be_taken(const Failure& failure) const
    {
        return has_sent_all_ && failure.exit == Exit::NotConnected;
    }

private:
    /// The outputs, of which there are at least `wanted`.
    std::vector<Variant> on(const NodeId& object, const char* method,
                            const std::vector<Variant>& inputs, std::size_t wanted);
    /// The same for a Method that is known.
    std::vector<Variant> on(const NodeId& object, const NodeId& method, const char* method_name,
                            const std::vector<Variant>& inputs, std::size_t wanted);
    void abandon(const NodeId& file, const Variant& handle);

    Connection& connection_;
    std::string name_;
    NodeId object_;
    bool has_sent_all_{false};
};

} // namespace busbar::tool::admin
