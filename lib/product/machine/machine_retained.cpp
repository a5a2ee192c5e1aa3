#include "machine_retained.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string>

#include <busbar/controller/retained_values.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/server/process_image.hpp>

namespace busbar::product {

namespace {

using Bytes = controller::FilePart::Bytes;

constexpr std::size_t max_size = 2 * server::ImageLayout::max_bytes;
/// Replaces the values if there are none, so that those of the program are dropped.
constexpr std::string_view none = "none\n";

std::span<const std::byte> view_of(std::string_view text)
{
    return std::as_bytes(std::span{text});
}

bool is_none(std::span<const std::byte> bytes)
{
    return std::ranges::equal(bytes, view_of(none));
}

std::string values_file()
{
    return controller::RetainedOptions{}.file;
}

Unexpected<Problem> problem_at(const Storage& storage, std::string_view name, StorageError error)
{
    return misconfigured(storage.place(name), std::string{text(error)}, status_of(error));
}

Configured<Bytes> values_in(Storage& state)
{
    auto bytes = read_file(state, values_file(), max_size);
    if (!bytes && bytes.error() != StorageError::NotFound) {
        return problem_at(state, values_file(), bytes.error());
    }
    return bytes ? *std::move(bytes) : Bytes{};
}

/// Removes the journal first, because its writes refer to the old values.
Configured<void> remove_values(Storage& state, bool with_file)
{
    for (const char* end : {".journal-1", ".journal-2", ""}) {
        const std::string name = values_file() + end;
        const auto removed = *end != 0 || with_file ? state.remove(name) : Stored<void>{};
        if (!removed && removed.error() != StorageError::NotFound) {
            return problem_at(state, name, removed.error());
        }
    }
    return {};
}

} // namespace

void MachineRetained::keep(const MachineProgram& program)
{
    const std::lock_guard lock{mutex_};
    controller::RetainedOptions options;
    options.interval = interval_;
    values_.emplace(storage_, program.types(), program.image(), options);
    const controller::RetainedRestore restored = values_->restore();
    for (const Problem& problem : restored.problems) {
        log_.write(LogLevel::Warning, "controller", text(problem));
    }
    if (restored.restored > 0) {
        log_.write(LogLevel::Info, "controller",
                   std::to_string(restored.restored) + " RETAIN variables have the values that "
                                                       "were kept");
    }
}

void MachineRetained::stop()
{
    const std::lock_guard lock{mutex_};
    values_.reset();
}

void MachineRetained::keep(const controller::ProgramAddition& added)
{
    const std::lock_guard lock{mutex_};
    if (!values_) {
        return;
    }
    values_->drop_others(added.types->program());
    values_->add(*added.types, added.image);
    for (const controller::ProgramImageAddition& each : added.retained) {
        values_->add(*added.types, each);
    }
    // Otherwise a variable that was deleted and returns would get its old value after a crash.
    static_cast<void>(told(values_->save()));
}

Stored<void> MachineRetained::save()
{
    const std::lock_guard lock{mutex_};
    return values_ ? told(values_->save()) : Stored<void>{};
}

bool MachineRetained::save_when_due(TimePoint now)
{
    const std::lock_guard lock{mutex_};
    if (!values_) {
        return true;
    }
    if (is_told_) {
        return told(values_->save()).has_value();
    }
    if (values_->next_deadline() > now) {
        return told(values_->sync()).has_value();
    }
    return told(values_->handle_deadline(now)).has_value();
}

/// False for a program that was replaced: its last scan was saved then.
bool MachineRetained::keeps(const server::ProcessImage& image, std::uint32_t handle) const
{
    return values_ && values_->is_of(image) && values_->keeps(handle);
}

StatusCode MachineRetained::keep(const server::ProcessImage&,
                                 std::span<const server::ImageWrite> writes)
{
    return values_->keep(writes) ? status::Good : status::Bad_ResourceUnavailable;
}

Stored<void> MachineRetained::told(Stored<void> saved)
{
    if (saved) {
        is_told_ = false;
    } else if (!is_told_) {
        is_told_ = true;
        log_.write(LogLevel::Error, "controller",
                   "values of RETAIN variables cannot be saved: " +
                       std::string{text(saved.error())});
    }
    return saved;
}

controller::MemoryItem values_item(Storage& state)
{
    const std::string name{restored_values_name};
    controller::MemoryItem item{.name = "Retained values",
                                .group = controller::MemoryGroup::RetainedValues,
                                .files = {name}};
    controller::FilePart part{.file = name};
    part.take = [&state](std::span<const std::byte> whole) -> Configured<Bytes> {
        if (is_none(whole)) {
            return Bytes{};
        }
        return whole.empty() ? values_in(state) : Bytes{whole.begin(), whole.end()};
    };
    part.put = [&state](std::span<const std::byte>,
                        std::span<const std::byte> own) -> Configured<Bytes> {
        auto there = values_in(state);
        if (!there || (own.empty() && there->empty())) {
            return there;
        }
        const auto bytes = own.empty() ? view_of(none) : own;
        return Bytes{bytes.begin(), bytes.end()};
    };
    item.part = std::move(part);
    return item;
}

Configured<void> take_up_values(Storage& files, Storage& state)
{
    const auto bytes = read_file(files, restored_values_name, max_size);
    if (!bytes) {
        // At a first start even the folder is missing.
        const bool has_none =
            bytes.error() == StorageError::NotFound || bytes.error() == StorageError::Away;
        return has_none ? Configured<void>{}
                        : problem_at(files, restored_values_name, bytes.error());
    }
    if (auto removed = remove_values(state, is_none(*bytes)); !removed) {
        return removed;
    }
    if (!is_none(*bytes)) {
        if (const auto put = state.replace(values_file(), *bytes, FileAccess::Owner); !put) {
            return problem_at(state, values_file(), put.error());
        }
    }
    const auto removed = files.remove(restored_values_name);
    return removed ? Configured<void>{} : problem_at(files, restored_values_name, removed.error());
}

} // namespace busbar::product
