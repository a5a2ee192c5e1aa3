#include "mapped_plant.hpp"

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/mapped_nodes.hpp>
#include <busbar/controller/model_set.hpp>
#include <busbar/types/ids.hpp>

#include "identity.hpp"

namespace busbar::bench {

using namespace controller;

namespace {

/// 15,000 items that are made are sampled in many pieces at once: more than wait by default where a
/// scan is late, and would be answered Bad_TooManyOperations.
constexpr std::size_t max_waiting = 4'096;

Configured<ModelSet> import(const MappedModel& model)
{
    ModelSet models{rd81opc96_model()};
    for (const ProjectModel& each : model_files(model)) {
        if (auto imported = models.import({each.name, each.text}); !imported) {
            return misconfigured(each.name, text(imported.error().list().front()));
        }
    }
    return models;
}

/// Bad_OutOfMemory and the like, which no figure comes of.
Unexpected<Problem> impossible(const char* where, StatusCode status)
{
    return misconfigured(where, "cannot be made", status);
}

} // namespace

Configured<Program> program_of_labels(std::size_t variables)
{
    std::string text = "{attribute 'publish' := 'public'}\nVAR_GLOBAL\n";
    for (std::size_t i = 0; i < variables; ++i) {
        text += "    " + mapped_name(i) + " : INT;\n";
    }
    return read_declarations(text + "END_VAR\n", "labels.st");
}

Configured<std::unique_ptr<MappedPlant>> MappedPlant::start(const MappedModel& model,
                                                            SamplingMode mode)
{
    std::unique_ptr<MappedPlant> plant{new MappedPlant{mode}};
    auto made = plant->make_labels(model.variable_count())
                    .and_then([&] { return plant->make_server(); })
                    .and_then([&] { return plant->map(model); })
                    .and_then([&] { return plant->make_image(model.variable_count()); });
    if (!made) {
        return Unexpected{std::move(made).error()};
    }
    plant->source_->start();
    plant->plc_ = std::thread{[&one = *plant] { one.scan_until_stopped(); }};
    plant->serving_ = std::thread{[&one = *plant] { one.loop_.run(*one.server_); }};
    return plant;
}

MappedPlant::~MappedPlant()
{
    is_stopping_ = true;
    if (serving_.joinable()) {
        loop_.stop();
        serving_.join();
    }
    if (plc_.joinable()) {
        plc_.join();
    }
}

Configured<void> MappedPlant::make_labels(std::size_t variables)
{
    auto program = program_of_labels(variables);
    if (!program) {
        return Unexpected{std::move(program).error()};
    }
    auto labels = SimulatedLabels::create(*std::move(program), {.max_waiting = max_waiting});
    if (!labels) {
        return Unexpected{std::move(labels).error()};
    }
    labels_ = *std::move(labels);
    const auto running = labels_->program();
    for (std::size_t i = 0; i < variables; i += 2) {
        const auto* const variable = running->variable(mapped_name(i));
        const auto handle = variable ? running->handle_of(*variable) : std::nullopt;
        if (!handle) {
            return impossible("labels", status::Bad_NotFound);
        }
        moving_.push_back(&labels_->memory().value<std::int16_t>(*handle));
    }
    return {};
}

Configured<void> MappedPlant::make_server()
{
    const auto port = loop_.listen("127.0.0.1", 0);
    auto identity = make_identity(wall_clock_.now());
    if (!port || !identity) {
        return impossible("server", port ? identity.error() : port.error());
    }
    url_ = "opc.tcp://127.0.0.1:" + std::to_string(*port);
    server::ServerConfig config;
    config.endpoint_url = url_;
    config.application_uri = "urn:busbar:bench";
    config.endpoints = {{}};
    config.endpoints[0].security = {crypto::find_policy_by_name("Basic256Sha256"),
                                    MessageSecurityMode::SignAndEncrypt};
    config.endpoints[0].allows_anonymous = true;
    config.endpoints[0].allows_user_name = false;
    config.identity = *std::move(identity);
    config.shutdown_delay = std::chrono::milliseconds{0};
    constexpr std::uint8_t everything = 0xFF;
    users_.set_anonymous_access(everything);
    const server::ServerEnvironment environment{.random = &random_,
                                                .wall_clock = &wall_clock_,
                                                .log = &log_,
                                                .validator = &validator_,
                                                .users = &users_,
                                                .waker = &loop_.waker()};
    auto made = server::Server::create(std::move(config), environment);
    if (!made) {
        return Unexpected{std::move(made).error()};
    }
    server_.emplace(*std::move(made));
    return {};
}

Configured<void> MappedPlant::map(const MappedModel& model)
{
    const auto models = import(model);
    if (!models) {
        return Unexpected{models.error()};
    }
    MappedOptions options;
    options.sampling = mode_;
    options.limits = MappedLimits::rd81opc96();
    options.max_batches = max_waiting;
    source_.emplace(labels_, options);
    static_cast<void>(server_->add_source(*source_));
    source_->set_space(&server_->address_space());
    const auto mapping = models->load_into(server_->address_space());
    if (!mapping) {
        return misconfigured("model", text(mapping.error().list().front()));
    }
    const MappedNodes mapped = map_nodes(server_->address_space(), types_, *mapping, *source_);
    return mapped.variables == model.variable_count()
               ? Configured<void>{}
               : misconfigured("model", "Variables cannot be served");
}

Configured<void> MappedPlant::make_image(std::size_t variables)
{
    server::ImageLayout layout;
    for (std::size_t i = 0; i < variables; ++i) {
        if (const auto added = layout.add({.type = BuiltInType::Int16}); !added) {
            return impossible("image", added.error());
        }
    }
    image_ = server::ProcessImage::create(std::move(layout));
    image_source_.emplace(image_);
    model::AddressSpace& space = server_->address_space();
    const auto index = space.add_namespace("urn:busbar:bench:plain");
    model::NewNode node;
    node.parent = space.find(id::ObjectsFolder);
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int16};
    variable.access_level = model::Access::ReadWrite;
    variable.source = server_->add_source(*image_source_);
    for (std::uint32_t i = 0; index && i < variables; ++i) {
        const std::string name = mapped_name(i);
        node.id = NodeId{*index, String::borrow(name)};
        node.browse_name = QualifiedName{*index, String::borrow(name)};
        variable.handle = i;
        if (const auto added = space.add_variable(node, variable); !added) {
            return impossible("image", added.error());
        }
        if (i % 2 == 0) {
            moving_.push_back(&image_->memory().value<std::int16_t>(i));
        }
    }
    return index ? Configured<void>{} : impossible("image", index.error());
}

void MappedPlant::scan_until_stopped()
{
    auto next = std::chrono::steady_clock::now();
    while (!is_stopping_) {
        image_->begin_scan();
        for (std::int16_t* const each : moving_) {
            *each = static_cast<std::int16_t>(static_cast<std::uint16_t>(*each) + 1U);
        }
        const DateTime now = wall_clock_.now();
        labels_->end_of_scan(now);
        image_->publish(now);
        next += cycle;
        std::this_thread::sleep_until(next);
    }
    labels_->halt(wall_clock_.now());
    image_->halt();
}

} // namespace busbar::bench
