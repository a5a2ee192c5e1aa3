#pragma once

#include <string>
#include <vector>

#include <busbar/channel/channel_types.hpp>

namespace busbar::example {

/// The controller's certificate and key from `folder`/own, made there if they are missing: the key
/// readable by its owner only. Throws ConfigError.
[[nodiscard]] channel::ApplicationIdentity load_identity(const std::string& folder,
                                                         const std::string& name,
                                                         const std::string& application_uri,
                                                         const std::vector<std::string>& host_names,
                                                         DateTime now);

} // namespace busbar::example
