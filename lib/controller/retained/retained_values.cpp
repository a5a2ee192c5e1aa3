#include <busbar/controller/retained_values.hpp>

#include <algorithm>
#include <cstring>

#include <busbar/core/text.hpp>
#include <busbar/server/image_structure.hpp>

#include "retained_file.hpp"
#include "server/image/image_types.hpp"
#include "type_print.hpp"

namespace busbar::controller {

namespace {

/// All of an image's variables with names and whatever else there is of each.
constexpr std::size_t max_file_size = 2 * server::ImageLayout::max_bytes;

/// Whether what lies at `from` is a value, whoever wrote the file: no text longer than its place,
/// no truth value of its own kind.
bool is_value(const server::ImagePlace& place, const std::byte* from)
{
    for (std::uint32_t i = 0; i < place.elements; ++i, from += place.stride) {
        if (place.is_structure()) {
            const auto members = place.structure->members();
            const bool are_values =
                std::all_of(members.begin(), members.end(), [&](const auto& member) {
                    return is_value(member, from + member.offset);
                });
            if (!are_values) {
                return false;
            }
        } else if (place.is_text()) {
            std::uint32_t size = 0;
            std::memcpy(&size, from, sizeof size);
            if (size > place.capacity && size != server::detail::ImageText::null_size) {
                return false;
            }
        } else if (place.type == BuiltInType::Boolean && std::to_integer<unsigned>(*from) > 1) {
            return false;
        }
    }
    return true;
}

} // namespace

RetainedValues::RetainedValues(Storage& storage, const ProgramTypes& types,
                               const ProgramImage& image, RetainedOptions options)
    : storage_{&storage}, options_{std::move(options)}, image_{image.image()},
      elementary_{image.elementary()}
{
    take_in(types, image.variables(), 0);
}

void RetainedValues::add(const ProgramTypes& types, const ProgramImageAddition& added)
{
    take_in(types, added.variables, added.first_handle);
}

void RetainedValues::take_in(const ProgramTypes& types, std::span<const std::size_t> indices,
                             std::uint32_t first_handle)
{
    detail::TypePrints prints{types, elementary_};
    for (std::uint32_t i = 0; i < indices.size(); ++i) {
        const GlobalVariable& variable = types.program().variables[indices[i]];
        if (variable.is_retained && !variable.is_constant) {
            // One that was there before was removed, and comes back in another place.
            const auto [known, is_new] =
                by_name_.emplace(fold_name(variable.name), variables_.size());
            Variable taken{variable.name, first_handle + i, prints.print(variable.type)};
            if (is_new) {
                variables_.push_back(std::move(taken));
            } else {
                variables_[known->second] = std::move(taken);
            }
        }
    }
}

RetainedRestore RetainedValues::restore()
{
    RetainedRestore result;
    const auto file = read_file(*storage_, options_.file, max_file_size);
    if (file) {
        restore_from(*file, result);
        saved_ = *file;
    } else if (file.error() != StorageError::NotFound) {
        has_unusable_file_ = true;
        result.problems.push_back(
            {.where = options_.file, .text = "cannot be read: " + std::string{text(file.error())}});
    }
    return result;
}

void RetainedValues::restore_from(std::span<const std::byte> file, RetainedRestore& result)
{
    detail::RetainedReader reader{file};
    if (!reader.problem().empty()) {
        has_unusable_file_ = true;
        result.problems.push_back({.where = options_.file, .text = reader.problem()});
    }
    while (const auto value = reader.next()) {
        const auto found = by_name_.find(fold_name(value->name));
        if (found == by_name_.end()) {
            continue; // it is no longer there, or no longer retained
        }
        const Variable& variable = variables_[found->second];
        if (variable.handle >= image_->layout().size()) {
            continue; // it was added, and the task has it already
        }
        const server::ImagePlace& place = image_->place(variable.handle);
        if (value->type_print != variable.type_print || value->bytes.size() != place.bytes() ||
            !is_value(place, value->bytes.data())) {
            result.problems.push_back(
                {.where = options_.file + ": " + printable(variable.name),
                 .text = "has another type than when its value was kept; it begins as declared"});
            continue;
        }
        std::memcpy(image_->memory().bytes(place), value->bytes.data(), value->bytes.size());
        ++result.restored;
    }
}

std::vector<std::byte> RetainedValues::content(const server::ImagePin& pin) const
{
    std::vector<detail::RetainedValue> values;
    values.reserve(variables_.size());
    for (const Variable& variable : variables_) {
        // Null if it was added after the scan, and has no value yet.
        if (const std::byte* const bytes = pin.bytes(variable.handle)) {
            values.push_back({variable.name,
                              variable.type_print,
                              {bytes, image_->place(variable.handle).bytes()}});
        }
    }
    detail::RetainedWriter writer{values.size()};
    for (const detail::RetainedValue& value : values) {
        writer.add(value);
    }
    return writer.take();
}

Stored<void> RetainedValues::save()
{
    const server::ImagePin pin = image_->pin();
    if (!pin) {
        return image_->has_scan() ? Stored<void>{not_stored(StorageError::Failed)} : Stored<void>{};
    }
    std::vector<std::byte> now = content(pin);
    if (now == saved_) {
        return {};
    }
    if (auto kept = keep_old_file(); !kept) {
        return kept;
    }
    if (auto written = storage_->replace(options_.file, now, FileAccess::Owner); !written) {
        // It may be there after all: the next call has to write.
        saved_.clear();
        return written;
    }
    saved_ = std::move(now);
    return {};
}

Stored<void> RetainedValues::keep_old_file()
{
    if (!has_unusable_file_) {
        return {};
    }
    auto moved = storage_->move(options_.file, options_.file + ".kept", WhenThere::Replace);
    if (!moved && moved.error() != StorageError::NotFound) {
        return moved;
    }
    has_unusable_file_ = false;
    return {};
}

Stored<void> RetainedValues::handle_deadline(TimePoint now)
{
    deadline_ = now + options_.interval;
    return save();
}

} // namespace busbar::controller
