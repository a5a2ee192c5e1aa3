#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::product {

/// A program that was sent to the controller over OPC UA. It replaces the configured file, also at
/// later starts, until another one is sent or it is removed.
///
/// Its document consists of a checksum, the name, the user and the time, a line each, and the text.
struct ReceivedProgram {
    /// File in the folder of certificates.
    static constexpr std::string_view file_name = "program.received";
    static constexpr std::size_t max_text = controller::DeclarationLimits{}.max_text_size;
    /// Maximum size of a document, including the lines before the text.
    static constexpr std::size_t max_size = max_text + 4'096;

    /// Name of the sender's file without a folder; its ending tells whether it is PLCopen XML.
    std::string name;
    std::string user;
    DateTime time;
    std::string text;
};

/// Tells whether a program can have this name: at most 255 bytes, not a path, no control
/// characters.
[[nodiscard]] bool is_program_name(std::string_view name);
[[nodiscard]] std::string document_of(const ReceivedProgram& program);
/// Parses a document; `place` is its place for a problem.
[[nodiscard]] Configured<ReceivedProgram> read_received(std::string_view document,
                                                        const std::string& place);
/// Replaces the stored document, or removes it, as a whole even in a power cut. Fails with a
/// problem of the Storage.
[[nodiscard]] Configured<void> keep_received(Storage& storage,
                                             const std::optional<std::string>& document);

} // namespace busbar::product
