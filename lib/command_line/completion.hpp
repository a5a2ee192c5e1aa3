#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
} // namespace CLI

/// Completion in a shell. The script of the shell has the program itself say what fits, so that it
/// is as new as the program, and knows what only a server can tell.
namespace busbar::command_line {

/// The command line at the moment at which the user asks for completion.
struct CompletionPlace {
    /// The innermost command that was typed.
    const CLI::App* command;
    /// The option whose value is typed; null if it is an argument.
    const CLI::Option* option{nullptr};
    /// All words before, without the program's name, and those of them that are the command's
    /// arguments.
    std::vector<std::string> words{};
    std::vector<std::string> arguments{};
    /// The word that is being typed, without quotes.
    std::string word{};
    /// Whether it begins with a quote.
    bool is_quoted{false};
};

/// Returns what may stand at a place that is neither a command nor an option with known values.
using Completer = std::function<std::vector<std::string>(const CompletionPlace&)>;

/// Lists an option's values for completion: pass it as the last argument of CLI::Option::check().
[[nodiscard]] std::string values_name(const std::vector<std::string>& values);

/// Reads a line up to the cursor as a shell does.
[[nodiscard]] CompletionPlace completion_place(const CLI::App& app, const std::string& line);
/// Returns the words that may stand at the end of the line. `completer` may be null.
[[nodiscard]] std::vector<std::string> completions(const CLI::App& app, const std::string& line,
                                                   const Completer& completer);
/// Returns the same without what the shell keeps, if it takes each of `breaks` for the end of a
/// word as bash does with COMP_WORDBREAKS.
[[nodiscard]] std::vector<std::string> completions(const CLI::App& app, const std::string& line,
                                                   const Completer& completer,
                                                   const std::string& breaks);

/// The script for "bash", "zsh" or "fish".
[[nodiscard]] std::string completion_script(const std::string& program, const std::string& shell);

} // namespace busbar::command_line
