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
#include <busbar/model/address_space.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/server.hpp>

namespace busbar::product {

/// Logs the events and error codes of labels (SH-082679, 8.3). Logs the first errors of each minute
/// and the number of the others, because a lasting error is reported again and again and must not
/// fill the log.
class LabelLog final : public controller::MappedObserver {
public:
    /// The last error and the last event, each with its time; a code of 0 is none.
    struct Last {
        std::uint16_t error_code{0};
        /// The text of the log, with label and node.
        std::string error{};
        DateTime error_time{};
        std::uint32_t error_count{0};
        std::uint16_t event_code{0};
        DateTime event_time{};
    };

    /// Both must outlive this object.
    LabelLog(LogSink& log, const WallClock& clock) : log_{log}, clock_{clock} {}

    void label_update(controller::LabelUpdate event) override;
    void error(const controller::MappedError& error) override;
    [[nodiscard]] const Last& last() const { return last_; }

private:
    void begin_period(DateTime now);

    LogSink& log_;
    const WallClock& clock_;
    /// Beginning of the current period, which is a minute, or starts with an update of labels.
    DateTime begin_{};
    /// Lines of the period, each once.
    std::set<std::string> told_{};
    /// Number of errors in the period without a line of their own.
    std::size_t untold_{0};
    Last last_{};
};

/// Shows what a LabelLog has last as Variables beside the module's buffer memory: LastErrorCode,
/// LastError, LastErrorTime, ErrorCount, LastEventCode and LastEventTime.
class LabelLogNodes final : public server::DataSource {
public:
    /// Both must outlive this object.
    LabelLogNodes(const LabelLog& log, const WallClock& clock) : log_{log}, clock_{clock} {}

    void read(server::ReadBatch batch) override;
    /// Adds them below the parent. This object must have been added to the server. Throws
    /// ConfigError.
    void add_to(model::AddressSpace& space, model::NodeIndex parent) const;

private:
    const LabelLog& log_;
    const WallClock& clock_;
};

/// The Variables and Methods that a project maps to labels, served by one server, which may end
/// before or after this object. Used on the server's thread.
class MappedModel {
public:
    struct Needs {
        server::Server& server;
        /// Indexed by the server's NodeIds.
        const controller::Mapping& mapping;
        const controller::Project& project;
        std::shared_ptr<backend::LabelBackend> labels;
        std::int32_t utc_offset_minutes;
        bool isolates_failures;
        /// See MappedOptions.
        std::chrono::milliseconds call_limit;
        const WallClock& clock;
        LogSink& log;
        /// Object that shows the module's buffer memory.
        model::NodeIndex module;
    };
    /// Binds the nodes; they answer Bad_NoCommunication until start(). Clock and log must outlive
    /// the server. Throws ConfigError.
    explicit MappedModel(const Needs& needs);

    /// Becomes the only listener of the labels.
    void start() { source_.start(); }
    /// Number of mapped Variables.
    [[nodiscard]] std::size_t variables() const { return variables_; }
    void stop() { source_.stop(); }

private:
    model::DataTypes types_;
    LabelLog events_;
    controller::MappedSource source_;
    controller::ModuleStatus status_;
    LabelLogNodes last_;
    std::size_t variables_{0};
};

} // namespace busbar::product
