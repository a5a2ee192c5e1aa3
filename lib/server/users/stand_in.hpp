#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace busbar::server::detail {

/// Which of `hashes`, the stored ones of all users, a password is checked against if nobody has the
/// name; `hashes` must not be empty. So that a stranger, whose clock sees what a hash costs, cannot
/// tell such a name from a user's, also where users' hashes cost different amounts:
///
/// - a name has the same hash each time, as a user has, and each user's is that of as many names;
/// - which one it is cannot be foretold without the hashes, which are secret;
/// - one hash more or less changes that of those names only which it takes or leaves, in whatever
///   order they are.
[[nodiscard]] std::size_t stand_in_for(std::string_view name,
                                       std::span<const std::string_view> hashes);

} // namespace busbar::server::detail
