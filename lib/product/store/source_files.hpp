#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <busbar/controller/checked_program.hpp>
#include <busbar/controller/text_encoding.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::product {

struct PlcTrial;

/// The options for reading the file of a program.
struct ProgramReading {
    /// Says what happens to declarations that cannot be served.
    controller::Unserved unserved{controller::Unserved::LeaveOut};
    /// The encoding of a text without a byte order mark.
    controller::TextEncoding encoding{controller::TextEncoding::Recognized};

    friend bool operator==(const ProgramReading&, const ProgramReading&) = default;
};

/// The text files of a configuration: its own file, and the programs and information models that it
/// names. Reads each once and remembers it, so that everything is made from the same texts, even if
/// the files change. A copy remembers the same.
class SourceFiles {
public:
    using Text = std::shared_ptr<const std::string>;
    using Program = std::shared_ptr<const controller::CheckedProgram>;
    using Labels = std::shared_ptr<const controller::Program>;
    /// Texts by path as in the configuration.
    using Texts = std::map<std::string, Text, std::less<>>;

    /// Remembers nothing yet.
    SourceFiles() = default;
    /// Remembers these texts as if they had been read.
    explicit SourceFiles(Texts texts) : texts_{std::move(texts)}, has_all_{!texts_.empty()} {}

    /// Returns a file's text. Bad_NotFound if it cannot be read, Bad_ConfigurationError for a
    /// directory, Bad_EncodingLimitsExceeded if it has more than `most` bytes.
    [[nodiscard]] Configured<Text> text(const std::string& path, std::size_t most);
    /// Returns the text of a program, whose path may also be that of a folder, of a .plcproj, or
    /// several paths with a line feed between them (controller::read_program_files).
    [[nodiscard]] Configured<Text> program_text(const std::string& path, std::size_t most);
    /// Sets the place of the ReceivedProgram, if there is one.
    void receive_at(std::string place) { received_place_ = std::move(place); }
    [[nodiscard]] const std::string& received_place() const { return received_place_; }
    /// Returns the document of the ReceivedProgram; nothing if there is none, or the initial texts
    /// had none. Fails like text().
    [[nodiscard]] Configured<std::optional<Text>> received();
    /// Results from preparing a program's file elsewhere. All may be null.
    struct Prepared {
        Text text{};
        Program program{};
        /// The labels, if it is a file of labels.
        Labels labels{};
        std::shared_ptr<const PlcTrial> tried{};
    };
    /// Returns these files with this document of a ReceivedProgram, for which `prepared` needs no
    /// text; or without one and with what was prepared from `file`, or with the file's present
    /// text.
    [[nodiscard]] SourceFiles with_program(const std::optional<std::string>& document,
                                           const std::string& file, Prepared prepared) const;
    /// Returns a copy without texts, so that all are read again; results are reused for texts that
    /// are still the same.
    [[nodiscard]] SourceFiles again() const;
    /// Returns a copy like that of again(), with what was prepared from this file, if the file
    /// still has that text.
    [[nodiscard]] SourceFiles again_with(const std::string& file, Prepared prepared) const;
    /// The texts read so far.
    [[nodiscard]] const Texts& texts() const { return texts_; }

    /// The program parsed from a file's text, so that it need not be parsed again; null if it was
    /// not parsed yet. For read_program_file.
    [[nodiscard]] Program& program(const std::string& path) { return programs_[path]; }
    /// The same for a file of labels, which has additional types.
    [[nodiscard]] Labels& labels(const std::string& path) { return labels_[path]; }
    /// The last PLC that was found possible; null for none.
    [[nodiscard]] std::shared_ptr<const PlcTrial>& tried() { return tried_; }

private:
    /// Remembers a text that was read now.
    [[nodiscard]] Text remember(const std::string& path, std::string text);

    using Programs = std::map<std::string, Program, std::less<>>;

    Texts texts_;
    /// Texts of the object that again() was called for.
    Texts texts_before_;
    /// True if the initial texts are complete.
    bool has_all_{false};
    std::string received_place_;
    /// Results for the texts, and for those of texts_before_.
    Programs programs_;
    std::map<std::string, Labels, std::less<>> labels_;
    std::shared_ptr<const PlcTrial> tried_;
};

} // namespace busbar::product
