#pragma once

namespace busbar::example {

/// --hash-password: reads a password from standard input, prints what a configuration may store.
/// The program's exit code.
[[nodiscard]] int hash_password();

} // namespace busbar::example
