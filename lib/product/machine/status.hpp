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

/// What was asked for and is not in force, and why. On the server's thread.
class PendingChanges {
public:
    /// How it was asked for.
    enum class By : std::uint8_t {
        Start,     // the files at the start: it runs with what it ran with last
        Listeners, // where it is told to listen
        Reload,    // the files when they were read again
        Download,  // a program that was sent
        Count
    };

    void ask(By by, std::string why) { reasons_[static_cast<std::size_t>(by)] = std::move(why); }
    /// It is in force, or not asked for any more.
    void done(By by) { ask(by, {}); }
    [[nodiscard]] bool has(By by) const { return !reason(by).empty(); }
    /// Empty: nothing is asked for in that way.
    [[nodiscard]] const std::string& reason(By by) const
    {
        return reasons_[static_cast<std::size_t>(by)];
    }
    /// The reasons of those that there are.
    [[nodiscard]] std::vector<std::string> reasons() const;

private:
    std::array<std::string, static_cast<std::size_t>(By::Count)> reasons_;
};

/// Where a status comes from. All must outlive the facts.
struct StatusSources {
    server::Server& server;
    /// What the server was made with.
    const ControllerConfig& config;
    const Settings& settings;
    /// Null if there is none.
    const Machine* machine;
    const PendingChanges& pending;
};

/// What the server's status says (W588, 4-2-1): Use, OperatingStatus, EndPoint (empty unless it
/// is Running), ConnectedClients, ConnectedUsers and their names; and beyond that HaltReason,
/// RestartReasons (empty: none is due), PendingChanges and CurrentErrors, each with what to do, and
/// GoesOnWithoutServer (a shutdown does not end the controller).
[[nodiscard]] std::vector<administration::StatusFact> status_facts(const StatusSources& sources);

} // namespace busbar::product
