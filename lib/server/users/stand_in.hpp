#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace busbar::server::detail {

/// Returns which of `hashes`, the stored ones of all users, a password is checked against if the
/// name is unknown; `hashes` must not be empty. A stranger, who can measure the time of a hash,
/// cannot tell such a name from a user's, even if users' hashes cost different amounts:
///
/// - a name has the same hash each time, as a user has, and each user's hash is that of the same
///   number of names;
/// - which one it is cannot be predicted without the hashes, which are secret;
/// - adding or removing a hash changes only the names that it takes or leaves, in whatever order
///   they are.
[[nodiscard]] std::size_t stand_in_for(std::string_view name,
                                       std::span<const std::string_view> hashes);

} // namespace busbar::server::detail
