#pragma once

#include <vector>

#include <busbar/controller/backup.hpp>

#include "product/configuration/settings.hpp"

namespace busbar::product {

/// What a machine's memory consists of (W588, 3-2-9, 8-2-1, 8-2-2 and 8-3), in a MachineFiles:
/// the program and the server settings; the values of RETAIN variables; the security profile of
/// certificates, revocation lists, users, roles and security settings (see is_security_setting),
/// which lie in one file with the other settings and are a part of their own in backups; the event
/// log; and what belongs to one controller alone: its own certificates, those that it rejected and
/// the code of its setup. The execution log is in none of it, nor are accounts of the
/// configuration's file.
///
/// A backup has the program and all settings, wherever they are from, so that another controller
/// works as this one (8-2-4); but addresses and files of this machine only if they were set online.
/// What the file of the controller that it is restored to says too is not said over it.
///
/// `settings`, which decides whether a program and settings of a backup make sense, must outlive
/// the result, and so must `state`, which has the values.
[[nodiscard]] std::vector<controller::MemoryItem> machine_items(Settings& settings, Storage& state);

} // namespace busbar::product
