#pragma once

#include <string>
#include <vector>

#include <busbar/core/log.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::example {

/// Adds the nodes of NodeSet2 files, given in any order, and logs what is odd in them. Throws a
/// ConfigError that has a line for each mistake; nothing was added then.
void load_models(model::AddressSpace& space, const std::vector<std::string>& files, LogSink& log);

} // namespace busbar::example
