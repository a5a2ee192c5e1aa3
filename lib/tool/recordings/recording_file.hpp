#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <busbar/harness/recorded_messages.hpp>
#include <busbar/harness/recording.hpp>

#include "tool/connection/context.hpp"

namespace busbar::tool {

/// The arguments that all comparing commands have.
struct ComparisonArguments {
    harness::ComparisonOptions options;
    /// File of a JUnit report; may be empty.
    std::string junit;
    /// The report has what was secret, and is for its owner alone.
    bool is_secret{false};
};
void add_comparison_options(CLI::App& command, ComparisonArguments& arguments);
/// The size of a file of keys is limited, in bytes.
inline constexpr std::size_t max_key_log = 16U << 20U;
/// Adds --keys, for read_recording_file().
void add_keys_option(CLI::App& command, std::string& keys);

/// Reads a recording; throws Failure, which says what the file is not. Secured channels are
/// decrypted if `keys` names a file that has their keys.
[[nodiscard]] harness::Recording read_recording_file(const std::string& path,
                                                     const std::string& keys = {});
/// Throws Failure if no message of the recording can be read, since its channels were secured. If
/// some cannot, tells so and returns false. `keys` is what read_recording_file() was given.
[[nodiscard]] bool check_readable(Context& context, const std::string& path,
                                  const std::vector<harness::RecordedMessage>& messages,
                                  const std::string& keys);
/// The exit of a comparison: Partly if nothing differs and not everything could be read.
[[nodiscard]] inline Exit exit_of_comparison(Exit exit, bool was_readable)
{
    return exit == Exit::Good && !was_readable ? Exit::Partly : exit;
}
/// One line of a message: its number, and what it is; with --json an object with all fields.
void print_message(Context& context, const harness::RecordedMessage& message);

/// Writes a JUnit report if the arguments name a file: one test case with the differences as its
/// failure.
void write_differences_report(const std::vector<std::string>& differences, std::string_view title,
                              const ComparisonArguments& arguments);
/// Prints what differs, one a line or as a JSON list, and writes the report. Good if there are
/// none.
[[nodiscard]] Exit print_differences(Context& context, const std::vector<std::string>& differences,
                                     std::string_view title, const ComparisonArguments& arguments);

} // namespace busbar::tool
