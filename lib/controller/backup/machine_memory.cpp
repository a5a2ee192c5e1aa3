#include <busbar/controller/backup.hpp>

#include <algorithm>
#include <set>
#include <utility>

#include <busbar/core/file_transaction.hpp>
#include <busbar/core/record.hpp>
#include <busbar/core/text.hpp>

#include "backup_file.hpp"
#include "memory_plan.hpp"

namespace busbar::controller {

using detail::SavedFile;
using detail::SavedItem;
using detail::SavedMemory;

namespace {

bool is_cleared(MemoryGroup group, bool with_security)
{
    return group == MemoryGroup::ServerSettings || group == MemoryGroup::RetainedValues ||
           (with_security && group != MemoryGroup::EventLog);
}

/// Finds the controller's item that an item of a backup is for.
Configured<const MemoryItem*> item_for(const SavedItem& saved, const std::vector<MemoryItem>& items)
{
    const auto found = std::find_if(items.begin(), items.end(), [&](const MemoryItem& item) {
        return item.name == saved.name && item.group == saved.group;
    });
    if (found == items.end()) {
        return misconfigured("backup", "found " + printable(saved.name) +
                                           ", which this controller does not have");
    }
    for (const SavedFile& file : saved.files) {
        if (!detail::has_file(*found, file.name)) {
            return misconfigured("backup", "found " + printable(file.name) +
                                               ", which is not a file of " + printable(saved.name));
        }
        if (!found->check || found->part) {
            continue;
        }
        if (auto checked = found->check(file.name, file.bytes); !checked) {
            return detail::wrong_in_backup(std::move(checked.error()));
        }
    }
    return &*found;
}

VerifiedItem compare(const SavedItem& saved, const SavedItem& there)
{
    std::set<std::string> differences;
    const auto find_others = [&](const SavedItem& left, const SavedItem& right) {
        for (const SavedFile& file : left.files) {
            const auto same =
                std::find_if(right.files.begin(), right.files.end(), [&](const SavedFile& other) {
                    return other.name == file.name && other.bytes == file.bytes;
                });
            if (same == right.files.end()) {
                differences.insert(file.name);
            }
        }
    };
    find_others(saved, there);
    find_others(there, saved);
    return {saved.name, {differences.begin(), differences.end()}};
}

} // namespace

MachineMemory::MachineMemory(Storage& storage, std::string transaction,
                             std::vector<MemoryItem> items, LogSink& log,
                             const MemoryLimits& limits)
    : storage_{&storage},
      transaction_{std::move(transaction)}, items_{std::move(items)}, log_{&log}, limits_{limits}
{
}

Configured<void> MachineMemory::recover() const
{
    if (const auto done = FileTransaction{*storage_, transaction_}.recover(); !done) {
        return detail::storage_problem(*storage_, transaction_, done.error());
    }
    return {};
}

Configured<std::vector<std::byte>> MachineMemory::backup(const BackupLabel& label,
                                                         const BackupChoice& choice) const
{
    // Finish a change first that was decided but still waits for the medium.
    if (auto recovered = recover(); !recovered) {
        return Unexpected{std::move(recovered.error())};
    }
    SavedMemory memory{label, !items_.empty(), {}};
    for (const MemoryItem& item : items_) {
        if (item.group == MemoryGroup::ServerCertificate ||
            (item.group == MemoryGroup::SecurityProfile && !choice.security_profile)) {
            continue;
        }
        auto saved = detail::read_item(*storage_, item, limits_);
        if (!saved) {
            return Unexpected{std::move(saved.error())};
        }
        memory.items.push_back(*std::move(saved));
    }
    auto file = detail::write_backup(memory);
    // Never hand out a backup that could not be restored.
    if (const auto again = detail::read_backup(file, limits_); !again) {
        return Unexpected{again.error()};
    }
    return file;
}

Configured<Restored> MachineMemory::restore(std::span<const std::byte> backup,
                                            const RestoreChoice& choice)
{
    const auto memory = read_for(backup, choice);
    if (!memory) {
        return Unexpected{memory.error()};
    }
    if (!memory->has_opc_ua) {
        return clear(true).transform([] { return Restored::Nothing; });
    }
    if (auto recovered = recover(); !recovered) {
        return Unexpected{std::move(recovered.error())};
    }
    if (auto done = put(*memory, choice); !done) {
        return Unexpected{std::move(done.error())};
    }
    const bool lacks_profile = choice.security_profile && detail::has_profile(items_) &&
                               !detail::has_profile(memory->items);
    return lacks_profile ? Restored::WithoutProfile : Restored::Data;
}

/// Reads the backup and gives each item of this controller the content that it is to have.
Configured<SavedMemory> MachineMemory::read_for(std::span<const std::byte> backup,
                                                const RestoreChoice& choice) const
{
    auto memory = detail::read_backup(backup, limits_);
    if (!memory) {
        return memory;
    }
    const auto is_divided = detail::divide_parts(*memory, items_, choice);
    return is_divided ? std::move(memory) : Unexpected{is_divided.error()};
}

Configured<void> MachineMemory::put(const SavedMemory& memory, const RestoreChoice& choice)
{
    detail::MemoryPlan plan{*storage_, limits_};
    for (const SavedItem& saved : memory.items) {
        if (!detail::is_restored(saved.group, choice)) {
            continue;
        }
        auto planned = item_for(saved, items_).and_then([&](const MemoryItem* item) {
            return plan.put(*item, saved.files);
        });
        if (!planned) {
            return planned;
        }
    }
    for (const MemoryItem& item : items_) {
        if (auto planned = plan.add_initial(item); !planned) {
            return planned;
        }
    }
    if (auto checked = plan.check_shared(); !checked) {
        return detail::wrong_in_backup(std::move(checked.error()));
    }
    return plan.carry_out(transaction_);
}

Configured<std::vector<VerifiedItem>> MachineMemory::verify(std::span<const std::byte> backup,
                                                            const RestoreChoice& choice) const
{
    const auto memory = read_for(backup, choice);
    if (!memory) {
        return Unexpected{memory.error()};
    }
    if (!memory->has_opc_ua) {
        return misconfigured("backup", "is of a controller without OPC UA server: there is nothing "
                                       "to compare");
    }
    if (auto recovered = recover(); !recovered) {
        return Unexpected{std::move(recovered.error())};
    }
    std::vector<VerifiedItem> verified;
    for (const SavedItem& saved : memory->items) {
        if (!detail::is_restored(saved.group, choice) ||
            saved.group == MemoryGroup::RetainedValues) {
            continue;
        }
        const auto there = item_for(saved, items_).and_then([&](const MemoryItem* item) {
            return detail::read_item(*storage_, *item, limits_);
        });
        if (!there) {
            return Unexpected{there.error()};
        }
        verified.push_back(compare(saved, *there));
    }
    return verified;
}

Configured<void> MachineMemory::clear_all(bool with_security, MachineMode mode)
{
    if (mode == MachineMode::Run) {
        return misconfigured("clear all memory", "found RUN mode, expected PROGRAM mode",
                             status::Bad_InvalidState);
    }
    return clear(with_security);
}

Configured<void> MachineMemory::clear_security()
{
    return clear(true);
}

Configured<void> MachineMemory::clear(bool with_security)
{
    if (auto recovered = recover(); !recovered) {
        return recovered;
    }
    detail::MemoryPlan plan{*storage_, limits_};
    for (const MemoryItem& item : items_) {
        auto planned =
            is_cleared(item.group, with_security) ? plan.clear(item) : Configured<void>{};
        planned = planned ? plan.add_initial(item) : planned;
        if (!planned) {
            return planned;
        }
    }
    if (auto checked = plan.check_shared(); !checked) {
        return checked;
    }
    auto done = plan.carry_out(transaction_);
    if (done && with_security) {
        Record record;
        record.kind = RecordKind::SecurityCleared;
        record.source = "memory";
        record.text = "the server's certificate and the security profile were cleared";
        tell(*log_, record);
    }
    return done;
}

} // namespace busbar::controller
