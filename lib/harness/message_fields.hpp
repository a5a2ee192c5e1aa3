#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace busbar::harness::detail {

/// The name of the specification as services spell it: "NodesToRead" is "nodesToRead".
[[nodiscard]] std::string spelled(std::string_view name);

/// One value in a message, by the names of the specification: "nodesToRead[0].nodeId" and
/// "ns=1;s=Level".
struct MessageField {
    std::string path;
    std::string text;

    /// The last name of the path, without an index.
    [[nodiscard]] std::string_view name() const;
};

/// A message in words.
struct MessageFields {
    /// Its structure: "ReadRequest".
    std::string_view name;
    /// In wire order. Of arrays, at most so many elements.
    std::vector<MessageField> fields;
};

/// Whether a DataValue is one field, or its parts are.
enum class DataValues : std::uint8_t { Whole, InParts };

/// Reads the body of a message: the NodeId of an encoding and a structure of namespace 0. Nothing
/// if it is neither.
[[nodiscard]] std::optional<MessageFields> read_message(std::span<const std::byte> body,
                                                        DataValues values = DataValues::Whole);

/// Returns one line: the name, and what says most about it: nodes, values, results. At most about
/// 160 characters.
[[nodiscard]] std::string summary_of(const MessageFields& message);

/// Gives a field of a message's body another value: the path as MessageField has it, the text as
/// client::parse_value() reads it. Returns why that cannot be, with what was found and what was
/// expected; empty if it was done.
[[nodiscard]] std::string edit_message(std::vector<std::byte>& body, std::string_view path,
                                       std::string_view text);

} // namespace busbar::harness::detail
