#include "memory_plan.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/text.hpp>

namespace busbar::controller::detail {

namespace {

template <typename Item>
bool has_group(const std::vector<Item>& items, MemoryGroup group)
{
    return std::any_of(items.begin(), items.end(),
                       [&](const Item& item) { return item.group == group; });
}

SavedItem* saved_as(std::vector<SavedItem>& saved, const MemoryItem& item)
{
    const auto found = std::find_if(saved.begin(), saved.end(), [&](const SavedItem& each) {
        return each.name == item.name && each.group == item.group;
    });
    return found != saved.end() ? &*found : nullptr;
}

/// Finds the saved item that contained `item`'s part in an earlier version.
const SavedItem* earlier_holder(std::vector<SavedItem>& saved, const MemoryItem& item,
                                const std::vector<MemoryItem>& items)
{
    for (const MemoryItem& other : items) {
        if (&other != &item && other.part && other.part->file == item.part->file) {
            if (const SavedItem* const found = saved_as(saved, other)) {
                return found;
            }
        }
    }
    return nullptr;
}

Configured<void> check_names(const SavedItem& saved, const MemoryItem& item)
{
    for (const SavedFile& file : saved.files) {
        if (file.name != item.files.front()) {
            return misconfigured("backup", "found " + printable(file.name) +
                                               ", which is not a file of " + printable(saved.name));
        }
    }
    return {};
}

Configured<std::vector<SavedFile>> divided(const SavedItem& saved, const MemoryItem& item)
{
    if (saved.files.empty()) {
        return std::vector<SavedFile>{};
    }
    auto files = part_of(item, saved.files.front().bytes);
    return files ? std::move(files)
                 : Configured<std::vector<SavedFile>>{wrong_in_backup(files.error())};
}

void take_over(SavedItem item, std::vector<SavedItem>& items)
{
    const auto there = std::find_if(items.begin(), items.end(), [&](const SavedItem& each) {
        return each.name == item.name && each.group == item.group;
    });
    if (there != items.end()) {
        there->files = std::move(item.files);
    } else {
        items.push_back(std::move(item));
    }
}

} // namespace

bool is_restored(MemoryGroup group, const RestoreChoice& choice)
{
    return group == MemoryGroup::ServerSettings || group == MemoryGroup::RetainedValues ||
           (group == MemoryGroup::SecurityProfile && choice.security_profile);
}

bool has_profile(const std::vector<SavedItem>& items)
{
    return has_group(items, MemoryGroup::SecurityProfile);
}

bool has_profile(const std::vector<MemoryItem>& items)
{
    return has_group(items, MemoryGroup::SecurityProfile);
}

Unexpected<Problem> wrong_in_backup(Problem problem)
{
    problem.where = "backup: " + problem.where;
    return Unexpected{std::move(problem)};
}

Configured<void> divide_parts(SavedMemory& memory, const std::vector<MemoryItem>& items,
                              const RestoreChoice& choice)
{
    const bool is_with_profile = has_profile(memory.items);
    std::vector<SavedItem> divided_items;
    for (const MemoryItem& item : items) {
        if (!item.part || !is_restored(item.group, choice)) {
            continue;
        }
        const SavedItem* from = saved_as(memory.items, item);
        if (from != nullptr) {
            if (auto checked = check_names(*from, item); !checked) {
                return checked;
            }
        }
        if (from == nullptr && (item.group != MemoryGroup::SecurityProfile || is_with_profile)) {
            from = earlier_holder(memory.items, item, items);
        }
        if (from == nullptr) {
            continue;
        }
        auto files = divided(*from, item);
        if (!files) {
            return Unexpected{std::move(files.error())};
        }
        divided_items.push_back({item.name, item.group, *std::move(files)});
    }
    // Only now: a part may have been taken from an item that gives up some of it.
    for (SavedItem& item : divided_items) {
        take_over(std::move(item), memory.items);
    }
    return {};
}

} // namespace busbar::controller::detail
