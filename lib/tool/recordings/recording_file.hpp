#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/harness/recorded_messages.hpp>
#include <busbar/harness/recording.hpp>

#include "tool/connection/context.hpp"

namespace busbar::tool {

/// Reads a recording; throws Failure, which says what the file is not.
[[nodiscard]] harness::Recording read_recording_file(const std::string& path);
/// Throws Failure if no message of the recording can be read, since its channels were secured.
void need_readable(const std::string& path, const std::vector<harness::RecordedMessage>& messages);
/// Writes one; throws Failure.
void write_recording_file(const std::string& path, const harness::Recording& recording);

/// One line of a message: its number, and what it is; with --json an object with all fields.
void print_message(Context& context, const harness::RecordedMessage& message);

/// Prints what differs, one a line or as a JSON list, and writes a JUnit report if `junit` names a
/// file: one test case with the differences as its failure. Good if there are none.
[[nodiscard]] Exit print_differences(Context& context, const std::vector<std::string>& differences,
                                     std::string_view title, const std::string& junit);

} // namespace busbar::tool
