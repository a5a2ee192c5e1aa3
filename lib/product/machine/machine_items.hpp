#pragma once

#include <vector>

#include <busbar/controller/backup.hpp>

#include "product/configuration/settings.hpp"

namespace busbar::product {

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
/// `state`, which has the values.
[[nodiscard]] std::vector<controller::MemoryItem> machine_items(Settings& settings, Storage& state);

} // namespace busbar::product
