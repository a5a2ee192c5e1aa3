#pragma once

#include <vector>

#include <busbar/controller/backup.hpp>

#include "product/configuration/settings.hpp"

namespace busbar::product {

/// What a machine's memory consists of (seed 000, 3-2-9, 8-2-1, 8-2-2 and 8-3), in a MachineFiles:
/// server settings, which are what was changed of the configuration online; the security profile of
/// certificates, revocation lists, users, roles and security settings (see is_security_setting),
/// which lie in one file with the other settings and are a part of their own in backups; the event
/// log; and what belongs to one controller alone: its own certificates, those that it rejected and
/// the code of its setup. The execution log is in none of it.
///
/// `settings`, which decides whether settings of a backup make sense, must outlive the result.
[[nodiscard]] std::vector<controller::MemoryItem> machine_items(Settings& settings);

} // namespace busbar::product
