#include <busbar/controller/mapped_source.hpp>

#include <utility>

#include "mapped_core.hpp"

namespace busbar::controller {

MappedSource::MappedSource(std::shared_ptr<backend::LabelBackend> backend,
                           const MappedOptions& options, MappedObserver* observer)
    : core_{std::make_unique<detail::MappedCore>(std::move(backend), options, observer)}
{
}

MappedSource::~MappedSource() = default;

std::uint64_t MappedSource::add(MappedVariable variable)
{
    return core_->table().add(std::move(variable));
}

std::uint64_t MappedSource::add(MappedMethod method)
{
    return core_->table().add(std::move(method));
}

void MappedSource::set_space(const model::SpaceReader* space)
{
    core_->set_space(space);
}

void MappedSource::start()
{
    core_->start();
}

void MappedSource::stop()
{
    core_->stop();
}

bool MappedSource::is_updating() const
{
    return core_->is_updating();
}

TargetStatus MappedSource::target_status() const
{
    return core_->target_status();
}

server::DataSourceOptions MappedSource::options() const
{
    const MappedOptions& options = core_->options();
    server::DataSourceOptions all;
    all.all_or_nothing = true;
    all.has_fixed_lengths = true; // 8.1, Write
    all.decides_services = true;  // 8.1, ServiceResult
    all.timeout = options.timeout;
    all.max_batches = options.max_batches;
    all.max_items = options.max_items;
    all.max_monitored_size = options.limits.max_monitored_size;
    return all;
}

void MappedSource::read(server::ReadBatch batch)
{
    core_->read(std::move(batch));
    core_->pump();
}

void MappedSource::write(server::WriteBatch batch)
{
    core_->begin(detail::make_write(std::move(batch)));
    core_->pump();
}

void MappedSource::call(server::CallBatch batch)
{
    core_->begin(detail::make_call(std::move(batch)));
    core_->pump();
}

Result<std::size_t> MappedSource::monitored_size(std::uint64_t handle) const
{
    const auto& variables = core_->table().variables();
    if (handle >= variables.size()) {
        return std::size_t{0};
    }
    const auto& shape = variables[static_cast<std::size_t>(handle)].shape;
    if (shape == nullptr) {
        return fail(status::Bad_NotSupported);
    }
    return shape->monitored_bytes();
}

void MappedSource::monitoring_changed(std::span<const server::Monitoring> changes)
{
    core_->monitoring_changed(changes);
    core_->pump();
}

void MappedSource::attach(server::Waker* waker)
{
    core_->inbox().waker().set(waker);
}

void MappedSource::handle_completions()
{
    core_->pump();
}

} // namespace busbar::controller
