#pragma once

#include <vector>

#include <busbar/crypto/security_policy.hpp>

#include "experiment.hpp"

namespace busbar::timing {

/// User name tokens that a server refuses: the time to read one and to look the user up, in a store
/// that is quicker than any that hashes passwords. The first class is wrong RSA padding.
[[nodiscard]] std::vector<InputClass> token_attempts(const crypto::SecurityPolicy& policy);

} // namespace busbar::timing
