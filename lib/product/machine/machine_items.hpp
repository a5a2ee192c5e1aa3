#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <busbar/controller/backup.hpp>

#include "product/configuration/settings.hpp"
#include "program_change.hpp"

namespace busbar::product {

/// The results of preparing the program of a backup, so that a restore need not prepare it while
/// the server waits.
struct RestoredProgram {
    std::string text;
    SourceFiles::Prepared prepared;
};
/// Prepares the program of a backup. If the backup has no usable one, `program` is empty, and the
/// restore reports the reason. Any thread, but not during a restore.
void prepare_restored(const ProgramBase& base, std::span<const std::byte> backup,
                      RestoredProgram& program);

/// Returns the items of a machine's memory (W588, 3-2-9, 8-2-1, 8-2-2 and 8-3) in a MachineFiles:
/// the program and the server settings; the values of RETAIN variables; the security profile of
/// certificates, revocation lists, users, roles and security settings (see is_security_setting),
/// which share a file with the other settings but are a separate item in backups; the event log;
/// and the items that belong to one controller alone: its own certificates, those that it rejected
/// and the code of its setup. The execution log and accounts of the configuration's file are not
/// part of the memory.
///
/// A backup has the program and all settings, whatever their origin, so that another controller
/// works like this one (8-2-4); but addresses and files of this machine only if they were set
/// online. A restore does not store settings that the file of the target controller has as well.
///
/// `settings`, which checks a backup's program and settings, must outlive the result, and so must
/// `state`, which has the values. `program` may be prepared before each restore; null if it never
/// is.
[[nodiscard]] std::vector<controller::MemoryItem>
machine_items(Settings& settings, Storage& state, std::shared_ptr<RestoredProgram> program = {});

} // namespace busbar::product
