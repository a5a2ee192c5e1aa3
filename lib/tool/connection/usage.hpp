#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "failure.hpp"

namespace CLI {
class App;
class ParseError;
} // namespace CLI

namespace busbar::tool {

/// "a, b, c".
[[nodiscard]] std::string joined(const std::vector<std::string>& words);
/// Names of the options of `app` and, since they are offered everywhere, of the program.
[[nodiscard]] std::vector<std::string> options_of(const CLI::App& app);

/// The candidate that `word` is most likely a misspelling of; empty if none is near.
[[nodiscard]] std::string nearest(std::string_view word,
                                  const std::vector<std::string>& candidates);

/// That there is no command of this name below `level`, and which one was probably meant.
[[nodiscard]] Failure unknown_command(const CLI::App& level, const std::string& word);
/// Explains an error of the command line: the unknown word, and the one that was probably meant.
[[nodiscard]] Failure usage_failure(const CLI::App& app, const CLI::ParseError& error);

} // namespace busbar::tool
