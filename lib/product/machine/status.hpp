#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <busbar/administration/status_fact.hpp>
#include <busbar/server/server.hpp>

#include "machine.hpp"
#include "product/configuration/settings.hpp"

namespace busbar::product {

/// Requested changes that are not in force, with the reasons. Used on the server's thread.
class PendingChanges {
public:
    /// The kind of request.
    enum class By : std::uint8_t {
        Start,     // the files at the start: the last good state is in use
        Listeners, // the proper listeners
        Reload,    // the files when they were read again
        Download,  // a program that was sent
        Count
    };

    void ask(By by, std::string why) { reasons_[static_cast<std::size_t>(by)] = std::move(why); }
    /// Removes a request that is in force or obsolete.
    void done(By by) { ask(by, {}); }
    [[nodiscard]] bool has(By by) const { return !reason(by).empty(); }
    /// Empty if there is no such request.
    [[nodiscard]] const std::string& reason(By by) const
    {
        return reasons_[static_cast<std::size_t>(by)];
    }
    /// The reasons of all pending requests.
    [[nodiscard]] std::vector<std::string> reasons() const;

private:
    std::array<std::string, static_cast<std::size_t>(By::Count)> reasons_;
};

/// The objects that a status is made from. All must outlive the facts.
struct StatusSources {
    server::Server& server;
    /// The configuration that the server was made with.
    const ControllerConfig& config;
    const Settings& settings;
    /// Null for none.
    const Machine* machine;
    const PendingChanges& pending;
    /// True while an administrator has shut the server down, and the controller goes on.
    const bool& is_shut_down;
    /// True if a shutdown does not end the controller.
    bool goes_on;
};

/// The facts of the server's status (W588, 4-2-1): Use, OperatingStatus, EndPoint (empty unless it
/// is Running), ConnectedClients, ConnectedUsers and their names; and in addition HaltReason,
/// RestartReasons (empty if none is due), PendingChanges and CurrentErrors, each with what to do,
/// and GoesOnWithoutServer (a shutdown does not end the controller).
[[nodiscard]] std::vector<administration::StatusFact> status_facts(const StatusSources& sources);

} // namespace busbar::product
