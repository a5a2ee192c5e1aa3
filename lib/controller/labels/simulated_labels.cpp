#include <busbar/controller/simulated_labels.hpp>

#include <utility>

#include "label_exchange.hpp"
#include "label_finder.hpp"
#include "label_server_side.hpp"
#include "label_task_side.hpp"

namespace busbar::controller {

namespace {

/// Lists what to copy when `next` replaces `now`: variables with the same name and with types that
/// have the same values.
std::vector<detail::CarriedValue> carried_values(const LabelProgram& now, const LabelProgram& next)
{
    std::vector<detail::CarriedValue> carried;
    for (const GlobalVariable& variable : next.types().program().variables) {
        const GlobalVariable* const before = now.variable(variable.name);
        const auto to = next.handle_of(variable);
        const auto from = before != nullptr ? now.handle_of(*before) : std::nullopt;
        if (!from || !to || before->is_constant || variable.is_constant ||
            now.types().print_of(before->type) != next.types().print_of(variable.type)) {
            continue;
        }
        server::ImageMemory& source = now.memory();
        server::ImageMemory& target = next.memory();
        const server::ImagePlace& place = target.layout()[*to];
        carried.push_back(
            {source.bytes(source.layout()[*from]), target.bytes(place), place.bytes()});
    }
    return carried;
}

} // namespace

SimulatedLabels::SimulatedLabels(std::shared_ptr<LabelProgram> program,
                                 const SimulatedLabelsOptions& options)
    : exchange_{std::make_unique<detail::LabelExchange>()}
{
    exchange_->program = std::move(program);
    exchange_->unserved = options.unserved;
    server_ = std::make_unique<detail::LabelServerSide>(*exchange_, options);
    task_ = std::make_unique<detail::LabelTaskSide>(*exchange_, options);
}

SimulatedLabels::~SimulatedLabels() = default;

Configured<std::unique_ptr<SimulatedLabels>>
SimulatedLabels::create(Program program, const SimulatedLabelsOptions& options)
{
    auto made = LabelProgram::create(std::move(program), options.unserved);
    if (!made) {
        return Unexpected<Problem>{std::move(made.error())};
    }
    return std::unique_ptr<SimulatedLabels>{new SimulatedLabels{std::move(*made), options}};
}

void SimulatedLabels::start(std::unique_ptr<backend::LabelRequest> request)
{
    server_->start(std::move(request));
}

void SimulatedLabels::attach(backend::LabelListener* listener)
{
    server_->attach(listener);
}

std::uint64_t SimulatedLabels::sampled(std::span<std::byte> bytes, DateTime& time)
{
    return server_->sampled(bytes, time);
}

std::optional<std::vector<backend::ResolvedLabel>>
SimulatedLabels::look_up(std::span<const std::string> names) const
{
    const std::shared_ptr<const LabelProgram> current = program();
    std::vector<backend::ResolvedLabel> labels;
    labels.reserve(names.size());
    for (const std::string& name : names) {
        const detail::FoundLabel found = detail::find_label(*current, name);
        labels.push_back(
            {.error = found.error, .kind = found.kind, .is_unsampled_device = found.is_unsampled});
    }
    return labels;
}

void SimulatedLabels::end_of_scan(DateTime now)
{
    task_->end_of_scan(now);
}

void SimulatedLabels::halt(DateTime now)
{
    task_->halt(now);
}

server::ImageMemory& SimulatedLabels::memory()
{
    return task_->program().memory();
}

Configured<void> SimulatedLabels::replace_program(Program program)
{
    auto made = LabelProgram::create(std::move(program), exchange_->unserved);
    if (!made) {
        return Unexpected<Problem>{std::move(made.error())};
    }
    static_cast<void>(exchange_->to_server.take_all());
    auto job = std::make_unique<detail::LabelJob>();
    job->program = *made;
    const std::lock_guard one_at_a_time{exchange_->replacing};
    // Do this without the mutex, which the server's thread needs.
    job->carried = carried_values(*exchange_->program, **made);
    {
        const std::lock_guard lock{exchange_->mutex};
        job->generation = ++exchange_->generation;
        exchange_->program = std::move(*made);
        exchange_->to_plc.give(std::move(job));
    }
    exchange_->listener.labels_changed();
    return {};
}

std::shared_ptr<const LabelProgram> SimulatedLabels::program() const
{
    const std::lock_guard lock{exchange_->mutex};
    return exchange_->program;
}

void SimulatedLabels::fail_with(backend::LabelStatus fault)
{
    exchange_->fault.store(fault, std::memory_order_relaxed);
}

} // namespace busbar::controller
