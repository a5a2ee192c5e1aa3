#pragma once

#include <vector>

#include <busbar/crypto/security_policy.hpp>

#include "experiment.hpp"

namespace busbar::timing {

/// OpenSecureChannel requests that a server refuses for all there is to refuse: the time from the
/// message's arrival to the answer. The first class is wrong RSA padding.
[[nodiscard]] std::vector<InputClass> open_attempts(const crypto::SecurityPolicy& policy);

} // namespace busbar::timing
