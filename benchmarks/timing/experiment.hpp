#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <busbar/crypto/security_policy.hpp>

namespace busbar::timing {

/// Something that is timed once.
using Attempt = std::function<void()>;

/// One kind of input. `prepare` makes a new one each time; only what it returns is timed.
struct InputClass {
    std::string name;
    std::function<Attempt()> prepare;
    /// An input that is meant to differ: shows that the experiment would see it.
    bool is_control{false};
};

struct Settings {
    std::size_t samples{2'000}; // of each class
    std::uint64_t seed{1};
};

/// Times the classes in random order and prints one line for each, compared to the first. The
/// number of classes that can be told apart from it, controls not counted.
[[nodiscard]] std::size_t run(const std::string& title, const std::vector<InputClass>& classes,
                              const Settings& settings);

/// OpenSecureChannel requests that a server refuses for all there is to refuse: the time from the
/// message's arrival to the answer. The first class is wrong RSA padding.
[[nodiscard]] std::vector<InputClass> open_attempts(const crypto::SecurityPolicy& policy);

/// User name tokens that a server refuses: the time to read one and to look the user up, in a store
/// that is quicker than any that hashes passwords. The first class is wrong RSA padding.
[[nodiscard]] std::vector<InputClass> token_attempts(const crypto::SecurityPolicy& policy);

} // namespace busbar::timing
