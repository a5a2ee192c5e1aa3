#include <busbar/controller/retained_values.hpp>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <map>
#include <set>
#include <unordered_set>

#include <busbar/core/text.hpp>
#include <busbar/server/image_structure.hpp>

#include "retained_file.hpp"
#include "retained_journal.hpp"
#include "server/image/image_types.hpp"

namespace busbar::controller {

namespace {

/// Large enough for all variables of an image with their names and types.
constexpr std::size_t max_file_size = 2 * server::ImageLayout::max_bytes;

/// Tells whether the bytes at `from` are a valid value, since the file may come from anywhere: no
/// text longer than its place, no truth value other than 0 and 1.
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
      elementary_{image.elementary()}, journal_{std::make_unique<detail::RetainedJournal>(
                                           storage, options_.file)}
{
    take_in(types, image.variables(), 0);
}

RetainedValues::~RetainedValues() = default;

void RetainedValues::add(const ProgramTypes& types, const ProgramImageAddition& added)
{
    take_in(types, added.variables, added.first_handle);
}

void RetainedValues::drop_others(const Program& edited)
{
    std::unordered_set<std::string> retained;
    for (const GlobalVariable& each : edited.variables) {
        if (each.is_retained && !each.is_constant) {
            retained.insert(fold_name(each.name));
        }
    }
    std::erase_if(variables_,
                  [&](const Variable& each) { return !retained.contains(fold_name(each.name)); });
    by_name_.clear();
    by_handle_.assign(by_handle_.size(), 0);
    for (std::size_t i = 0; i < variables_.size(); ++i) {
        by_name_.emplace(fold_name(variables_[i].name), i);
        by_handle_[variables_[i].handle] = i + 1;
    }
}

void RetainedValues::take_in(const ProgramTypes& types, std::span<const std::size_t> indices,
                             std::uint32_t first_handle)
{
    for (std::uint32_t i = 0; i < indices.size(); ++i) {
        const GlobalVariable& variable = types.program().variables[indices[i]];
        if (variable.is_retained && !variable.is_constant) {
            const std::uint32_t handle = first_handle + i;
            // A variable of this name was removed, and returns at another place.
            const auto [known, is_new] =
                by_name_.emplace(fold_name(variable.name), variables_.size());
            Variable taken{variable.name, handle, types.print_of(variable.type, elementary_)};
            if (is_new) {
                variables_.push_back(std::move(taken));
            } else {
                by_handle_[variables_[known->second].handle] = 0;
                variables_[known->second] = std::move(taken);
            }
            by_handle_.resize(std::max<std::size_t>(by_handle_.size(), handle + 1));
            by_handle_[handle] = known->second + 1;
        }
    }
}

/// Values on their way into the image's memory: those of the file, overwritten by the journal's,
/// which may be parts of variables.
class RetainedValues::Restoring {
public:
    Restoring(const RetainedValues& owner, RetainedRestore& result) : owner_{owner}, result_{result}
    {
    }

    void add_file(const detail::RetainedValue& value)
    {
        if (const Variable* const variable = find(value.name, value.type_print)) {
            const std::size_t size = owner_.image_->place(variable->handle).bytes();
            if (value.bytes.size() != size) {
                return refuse(*variable);
            }
            values_[variable->handle].assign(value.bytes.begin(), value.bytes.end());
        }
    }
    void add_write(const detail::JournalEntry& entry)
    {
        const Variable* const variable = find(entry.name, entry.type_print);
        if (variable == nullptr) {
            return;
        }
        const server::ImagePlace& place = owner_.image_->place(variable->handle);
        if (entry.offset > place.bytes() || entry.bytes.size() > place.bytes() - entry.offset) {
            return refuse(*variable);
        }
        std::vector<std::byte>& value = values_[variable->handle];
        if (value.empty()) { // it keeps the declared value
            const std::byte* const declared = owner_.image_->memory().bytes(place);
            value.assign(declared, declared + place.bytes());
        }
        std::ranges::copy(entry.bytes, value.begin() + entry.offset);
    }
    void finish()
    {
        for (const auto& [handle, value] : values_) {
            const server::ImagePlace& place = owner_.image_->place(handle);
            if (!is_value(place, value.data())) {
                refuse(owner_.variables_[owner_.by_handle_[handle] - 1]);
                continue;
            }
            std::ranges::copy(value, owner_.image_->memory().bytes(place));
            ++result_.restored;
        }
    }

private:
    /// Finds the variable; null if it is gone, was added while the task ran, or has another type.
    const Variable* find(std::string_view name, std::uint64_t type_print)
    {
        const auto found = owner_.by_name_.find(fold_name(name));
        if (found == owner_.by_name_.end()) {
            return nullptr; // the variable is gone or no longer retained
        }
        const Variable& variable = owner_.variables_[found->second];
        if (variable.handle >= owner_.image_->layout().size()) {
            return nullptr; // added later: the task already uses it
        }
        if (type_print != variable.type_print) {
            refuse(variable);
            return nullptr;
        }
        return &variable;
    }
    void refuse(const Variable& variable)
    {
        if (refused_.insert(variable.handle).second) {
            result_.problems.push_back(
                {.where = owner_.options_.file + ": " + printable(variable.name),
                 .text = "has another type than when its value was saved; it starts with its "
                         "declared value"});
        }
    }

    const RetainedValues& owner_;
    RetainedRestore& result_;
    /// Values by handle.
    std::map<std::uint32_t, std::vector<std::byte>> values_;
    std::set<std::uint32_t> refused_;
};

RetainedRestore RetainedValues::restore()
{
    RetainedRestore result;
    Restoring restoring{*this, result};
    std::uint64_t last_write = 0;
    std::string unreadable; // report a medium that is away only once
    auto file = read_file(*storage_, options_.file, max_file_size);
    if (file) {
        detail::RetainedReader reader{*file};
        has_unusable_file_ = !reader.problem().empty();
        if (has_unusable_file_) {
            result.problems.push_back({.where = options_.file, .text = reader.problem()});
        }
        while (const auto value = reader.next()) {
            restoring.add_file(*value);
        }
        last_write = reader.last_write();
        saved_ = *std::move(file);
    } else if (file.error() != StorageError::NotFound) {
        has_unusable_file_ = true;
        unreadable = "cannot be read: " + std::string{text(file.error())};
        result.problems.push_back({.where = options_.file, .text = unreadable});
    }
    const auto problems = journal_->recover(
        last_write, [&](const detail::JournalEntry& entry) { restoring.add_write(entry); });
    std::ranges::copy_if(problems, std::back_inserter(result.problems),
                         [&](const Problem& each) { return each.text != unreadable; });
    restoring.finish();
    if (!journal_->is_empty()) {
        const auto begun = [&](std::uint32_t handle) -> const std::byte* {
            const bool is_there = handle < image_->layout().size();
            return is_there ? image_->memory().bytes(image_->place(handle)) : nullptr;
        };
        // A failed save stays due; its next attempt reports the reason.
        static_cast<void>(save(content(begun, journal_->begin_save())));
    }
    return result;
}

std::vector<std::byte> RetainedValues::content(BytesOf bytes_of, std::uint64_t last_write) const
{
    std::vector<detail::RetainedValue> values;
    values.reserve(variables_.size());
    for (const Variable& variable : variables_) {
        if (const std::byte* const bytes = bytes_of(variable.handle)) {
            values.push_back({variable.name,
                              variable.type_print,
                              {bytes, image_->place(variable.handle).bytes()}});
        }
    }
    detail::RetainedWriter writer{values.size(), last_write};
    for (const detail::RetainedValue& value : values) {
        writer.add(value);
    }
    return writer.take();
}

Stored<void> RetainedValues::save()
{
    // Take the number first: a scan that is read afterwards has all writes up to it.
    const std::uint64_t last_write = journal_->begin_save();
    const server::ImagePin pin = image_->pin();
    if (!pin) {
        return image_->has_scan() ? Stored<void>{not_stored(StorageError::Failed)} : Stored<void>{};
    }
    // Null if it was added after the scan, and has no value yet.
    const auto bytes_of = [&](std::uint32_t handle) { return pin.bytes(handle); };
    return save(content(bytes_of, last_write));
}

Stored<void> RetainedValues::save(std::vector<std::byte> now)
{
    if (now == saved_) {
        return journal_->saved();
    }
    if (auto kept = keep_old_file(); !kept) {
        return kept;
    }
    if (auto written = storage_->replace(options_.file, now, FileAccess::Owner); !written) {
        // The file may exist after all: the next call must write.
        saved_.clear();
        return written;
    }
    saved_ = std::move(now);
    return journal_->saved();
}

Stored<void> RetainedValues::keep(std::span<const server::ImageWrite> writes)
{
    std::vector<detail::JournalEntry> entries;
    entries.reserve(writes.size());
    for (const server::ImageWrite& write : writes) {
        const Variable& variable = variables_[by_handle_[write.handle] - 1];
        entries.push_back({variable.name, variable.type_print, write.offset, write.bytes});
    }
    return journal_->append(entries);
}

Stored<void> RetainedValues::sync()
{
    return journal_->sync();
}

TimePoint RetainedValues::next_deadline() const
{
    return journal_->needs_save() ? TimePoint::min() : deadline_;
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
