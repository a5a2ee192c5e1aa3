#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <set>
#include <string>

#include <busbar/controller/mapped_source.hpp>
#include <busbar/controller/mapping.hpp>
#include <busbar/controller/module_status.hpp>
#include <busbar/controller/project.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/server/server.hpp>

namespace busbar::product {

/// Writes what happens to labels to the log: the events and error codes of SH-082679, 8.3. Of many
/// errors the first ones of each minute, and how many more there were: an error that goes on is
/// told again and again, and fills no log.
class LabelLog final : public controller::MappedObserver {
public:
    /// Both must outlive it.
    LabelLog(LogSink& log, const WallClock& clock) : log_{log}, clock_{clock} {}

    void label_update(controller::LabelUpdate event) override;
    void error(const controller::MappedError& error) override;

private:
    void begin_period(DateTime now);

    LogSink& log_;
    const WallClock& clock_;
    /// A period of a minute, or from an update of labels on.
    DateTime begin_{};
    /// The lines of it, each once.
    std::set<std::string> told_{};
    /// Errors of it without a line of their own.
    std::size_t untold_{0};
};

/// What a project has mapped to labels, served by one server, which may end before it or after it.
/// On the server's thread.
class MappedModel {
public:
    struct Needs {
        server::Server& server;
        /// By the server's NodeIds.
        const controller::Mapping& mapping;
        const controller::Project& project;
        std::shared_ptr<backend::LabelBackend> labels;
        std::int32_t utc_offset_minutes;
        bool isolates_failures;
        /// See MappedOptions.
        std::chrono::milliseconds call_limit;
        const WallClock& clock;
        LogSink& log;
        /// Where the values of the module's buffer memory are shown.
        model::NodeIndex module;
    };
    /// Binds the nodes; they answer Bad_NoCommunication until start(). Clock and log must outlive
    /// the server. Throws ConfigError.
    explicit MappedModel(const Needs& needs);

    /// The labels have no other listener from here on.
    void start() { source_.start(); }
    /// How many are mapped.
    [[nodiscard]] std::size_t variables() const { return variables_; }
    void stop() { source_.stop(); }

private:
    model::DataTypes types_;
    LabelLog events_;
    controller::MappedSource source_;
    controller::ModuleStatus status_;
    std::size_t variables_{0};
};

} // namespace busbar::product
