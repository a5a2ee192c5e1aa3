#pragma once

#include <string>

#include "recording_file.hpp"
#include "tool/connection/context.hpp"

namespace busbar::tool {

/// Prints what differs between the nodes of two servers, except those of namespace 0 and those that
/// describe sessions; Failed if something does. Nodes are the same if their NodeIds are, by the
/// URIs of namespaces and not their indices; namespace 1, which is each server's own, is the same
/// one. Throws Failure. Partly if a server did not show all and nothing differs.
[[nodiscard]] Exit diff_servers(Context& context, const std::string& first,
                                const std::string& second, bool with_values,
                                const ComparisonArguments& arguments);

} // namespace busbar::tool
