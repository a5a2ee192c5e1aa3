#pragma once

#include <cstdint>
#include <memory>

#include <busbar/controller/mapped_source.hpp>
#include <busbar/controller/mapping.hpp>
#include <busbar/controller/module_status.hpp>
#include <busbar/controller/project.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/server/server.hpp>

namespace busbar::product {

/// Writes what happens to labels to the log: the events and error codes of seed 001, 8.3. Of many
/// errors in a row the first ones.
class LabelLog final : public controller::MappedObserver {
public:
    explicit LabelLog(LogSink& log) : log_{log} {}

    void label_update(controller::LabelUpdate event) override;
    void error(const controller::MappedError& error) override;

private:
    LogSink& log_;
    /// Since the last update of labels.
    std::size_t errors_{0};
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
    void stop() { source_.stop(); }

private:
    model::DataTypes types_;
    LabelLog events_;
    controller::MappedSource source_;
    controller::ModuleStatus status_;
};

} // namespace busbar::product
