#include "restored_values.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string>

#include <busbar/controller/retained_values.hpp>
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
