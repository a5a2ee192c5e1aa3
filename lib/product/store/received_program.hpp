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

/// A program that was sent to the controller over OPC UA. It counts instead of the file that the
/// configuration names, at each start too, until another one is sent or it is taken back.
///
/// Its document is a checksum, the name, the user and the time, a line each, and the text.
struct ReceivedProgram {
    /// In the folder of certificates.
    static constexpr std::string_view file_name = "program.received";
    static constexpr std::size_t max_text = controller::DeclarationLimits{}.max_text_size;
    /// Of a document, with what stands before the text.
    static constexpr std::size_t max_size = max_text + 4'096;

    /// That of the sender's file: a name without a folder, by whose end it is PLCopen XML or not.
    std::string name;
    std::string user;
    DateTime time;
    std::string text;
};

/// Whether a program can be called this: at most 255 bytes, no path, no control characters.
[[nodiscard]] bool is_program_name(std::string_view name);
[[nodiscard]] std::string document_of(const ReceivedProgram& program);
/// `place` is for the problem: where the document lies.
[[nodiscard]] Configured<ReceivedProgram> read_received(std::string_view document,
                                                        const std::string& place);
/// Puts this document, or none, where the one before is: whole or not at all, also in a power cut.
/// The problem is one of the Storage.
[[nodiscard]] Configured<void> keep_received(Storage& storage,
                                             const std::optional<std::string>& document);

} // namespace busbar::product
