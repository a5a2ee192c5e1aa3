#include "machine.hpp"

#include <utility>

#include <busbar/server/namespace_metadata.hpp>
#include <busbar/types/ids.hpp>

#include "machine_section.hpp"

namespace busbar::example {

namespace {

constexpr const char* machine_uri = "urn:busbar:machine";
/// Files of the execution log are at most 100 (seed 000, 7-1-5).
constexpr std::size_t most_log_entries = 1'000;

template <typename T>
T expect_done(Result<T> result, const std::string& what)
{
    if (!result) {
        throw ConfigError{Problem{result.error(), what, "failed"}};
    }
    if constexpr (!std::is_void_v<T>) {
        return *std::move(result);
    }
}

void make_root(storage::FolderStorage& folder)
{
    if (const auto made = folder.make_folder("", FileAccess::Owner); !made) {
        throw ConfigError{folder.place(""), std::string{text(made.error())}};
    }
}

} // namespace

Machine::Machine(const ControllerConfig& config, const WallClock& clock, LogSink& lines)
    : config_{config}, program_{publish_program(config)}, state_{config.machine.state_folder},
      medium_{config.machine.medium_folder}, log_folder_{medium_,
                                                         controller::ExecutionLogOptions{}.folder}
{
    make_root(state_);
    make_root(medium_);
    // The event log comes behind the execution log, which tells it what cannot be saved.
    event_log_ = expect(controller::MachineEventLog::create(state_, clock, lines, &raiser_));
    if (config.machine.execution_log.is_recorded) {
        controller::ExecutionLogOptions options;
        options.max_files = config.machine.execution_log.files;
        options.max_records = config.machine.execution_log.records;
        // One whole Preparing waits, as large as this one is.
        options.max_waiting += program_->program().variables.size();
        execution_log_ =
            expect(controller::ExecutionLog::create(medium_, clock, *event_log_, options));
    }
    life_ = std::make_unique<controller::LifeCycle>(static_cast<controller::ServerOperator&>(*this),
                                                    clock, log());
    saver_.emplace([this] { return save_pending(); });
    life_->mode_changed(config.machine.mode);
    life_->power_on();
}

Machine::~Machine()
{
    saver_.reset();
}

bool Machine::save_pending()
{
    const bool is_kept = event_log_->write_pending().has_value();
    if (!execution_log_) {
        return is_kept;
    }
    const bool is_logged = execution_log_->write_pending().has_value();
    look_for_log_files();
    return is_logged && is_kept;
}

void Machine::look_for_log_files()
{
    const auto listing = log_folder_.list("", most_log_entries);
    if (!listing && listing.error() != StorageError::NotFound) {
        return; // what cannot be read now is not gone
    }
    std::vector<std::string> names;
    if (listing) {
        for (const StorageEntry& entry : listing->entries) {
            names.push_back(entry.name);
        }
    }
    if (names != log_files_) {
        log_files_ = std::move(names);
        has_changed_files_ = true;
    }
}

std::vector<administration::FileSystem> Machine::file_systems()
{
    if (!execution_log_) {
        return {};
    }
    const auto roles = [](std::initializer_list<std::uint32_t> ids) {
        std::vector<NodeId> nodes;
        for (const std::uint32_t id : ids) {
            nodes.emplace_back(std::uint16_t{0}, id);
        }
        return nodes;
    };
    administration::FileSystem log{.name = "ExecutionLog", .storage = &log_folder_};
    // Its files may be removed, but what is in them is the controller's alone.
    log.limits.max_file_size = 0;
    log.limits.max_written = 0;
    log.limits.max_entries = most_log_entries;
    log.limits.max_depth = 1;
    log.readers =
        roles({id::WellKnownRole_Operator, id::WellKnownRole_Supervisor, id::WellKnownRole_Engineer,
               id::WellKnownRole_ConfigureAdmin, id::WellKnownRole_SecurityAdmin});
    log.writers = roles({id::WellKnownRole_Supervisor, id::WellKnownRole_Engineer,
                         id::WellKnownRole_SecurityAdmin});
    return {log};
}

LogSink& Machine::log()
{
    if (execution_log_) {
        return *execution_log_;
    }
    return *event_log_;
}

std::unique_ptr<controller::Plc> Machine::make_plc(server::Server& server)
{
    const std::uint16_t index =
        expect_done(server.address_space().add_namespace(machine_uri), "the machine's namespace");
    image_ =
        expect(program_->make_image(index, {.image = config_.image,
                                            .elementary = controller::MachineTypes::elementary_in(
                                                server.address_space(), config_.machine.types)}));
    return expect(controller::Plc::create(config_.plc, program_->types(), *image_));
}

controller::MachineNodesOptions Machine::node_options(std::uint32_t source) const
{
    controller::MachineNodesOptions options;
    options.namespace_uri = machine_uri;
    options.controller_name =
        config_.machine.name.empty() ? config_.server.application_name : config_.machine.name;
    options.types = config_.machine.types;
    options.source = source;
    options.cycle = config_.scan;
    options.has_events = true;
    return options;
}

model::NodeIndex Machine::publish(server::Server& server, std::uint32_t source)
{
    model::AddressSpace& space = server.address_space();
    nodes_ = expect(controller::MachineNodes::create(
        space, program_->program(), program_->publication(), node_options(source)));
    nodes_->set_mode(space, config_.machine.mode == controller::MachineMode::Run
                                ? controller::OperatingMode::Run
                                : controller::OperatingMode::Program);
    const model::NodeIndex folder = space.resolve(nodes_->folder());
    expect_done(raiser_.attach(space, folder, server.event_queue()), "the machine's events");
    tell(log(), program_->publication());
    return folder;
}

void Machine::run(const std::string& endpoint_url)
{
    life_->prepared(preparation_, endpoint_url);
}

void Machine::cannot_start(const std::string& why)
{
    life_->preparation_failed(preparation_, controller::PreparationFailure::Start, why);
    save_now();
}

void Machine::shut_down()
{
    static_cast<void>(life_->shut_down("the controller ends"));
}

void Machine::initialize()
{
    controller::ServerSettings settings;
    settings.is_used = true;
    settings.port = config_.port;
    settings.execution_log = config_.machine.execution_log;
    life_->initialized(settings);
}

void Machine::prepare(std::uint32_t number, const controller::ServerSettings&)
{
    preparation_ = number;
}

void Machine::reconfigure(std::uint32_t number, const controller::ServerSettings&,
                          const controller::StopNotice&)
{
    preparation_ = number;
}

void Machine::stop(const controller::StopNotice&)
{
    life_->stopped();
    save_now();
}

void Machine::medium_changed(bool is_in)
{
    if (execution_log_) {
        execution_log_->medium_changed(is_in ? controller::LogMedium::In
                                             : controller::LogMedium::Out);
    }
}

void Machine::save_now()
{
    // What fails is told by the logs themselves.
    if (execution_log_) {
        static_cast<void>(execution_log_->flush());
    }
    static_cast<void>(event_log_->write_pending());
}

} // namespace busbar::example
