#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "quotas.hpp"

namespace busbar::bench {

/// Who costs a server the time of password hashes: administrators of their own name, each of whom
/// adds users, changes his password, right and wrong, and guesses at logins, all at once.
class PasswordAttackers {
public:
    /// As many as that, by a user who is SecurityAdmin at the endpoint of `options`; the names and
    /// passwords are this bench's own.
    [[nodiscard]] static Result<PasswordAttackers> add(const Options& options, std::size_t count);

    /// Of the first so many of them. This must outlive it.
    [[nodiscard]] Attack attack(std::size_t attackers) const;

private:
    explicit PasswordAttackers(Options options) : options_{std::move(options)} {}

    Options options_;
};

} // namespace busbar::bench
