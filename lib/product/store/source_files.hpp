#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <busbar/controller/checked_program.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::product {

struct PlcTrial;

/// The text files that a configuration is made of: its own file, and the programs and information
/// models that it names. Each is read once and remembered, so that all that is made of them later
/// is made of the same texts, whatever lies on the disk by then. A copy remembers the same.
class SourceFiles {
public:
    using Text = std::shared_ptr<const std::string>;
    using Program = std::shared_ptr<const controller::CheckedProgram>;
    using Labels = std::shared_ptr<const controller::Program>;
    /// By their paths, as the configuration has them.
    using Texts = std::map<std::string, Text, std::less<>>;

    /// Remembers nothing yet.
    SourceFiles() = default;
    /// Remembers these, as if it had read them.
    explicit SourceFiles(Texts texts) : texts_{std::move(texts)}, has_all_{!texts_.empty()} {}

    /// What the file has. Bad_NotFound if it cannot be read, Bad_ConfigurationError for a
    /// directory, Bad_EncodingLimitsExceeded if it has more than `most` bytes.
    [[nodiscard]] Configured<Text> text(const std::string& path, std::size_t most);
    /// A ReceivedProgram lies there, or none.
    void receive_at(std::string place) { received_place_ = std::move(place); }
    [[nodiscard]] const std::string& received_place() const { return received_place_; }
    /// The document of the ReceivedProgram; nothing if there is none, or none among texts that it
    /// was made with. Problems as of text().
    [[nodiscard]] Configured<std::optional<Text>> received();
    /// What was made of a program's file elsewhere. All may be null.
    struct Prepared {
        Text text{};
        Program program{};
        std::shared_ptr<const PlcTrial> tried{};
    };
    /// These, but with this document of a ReceivedProgram, for which `prepared` needs no text; or
    /// with none, and with what was prepared of `file`, or whatever lies there by then.
    [[nodiscard]] SourceFiles with_program(const std::optional<std::string>& document,
                                           const std::string& file, Prepared prepared) const;
    /// Remembers no texts, so that all are read again, but what was made of those that turn out to
    /// be the same.
    [[nodiscard]] SourceFiles again() const;
    /// What was read so far.
    [[nodiscard]] const Texts& texts() const { return texts_; }

    /// The program that a file's text was read as, so that it need not be read again; null if it
    /// was not yet. For read_program_file.
    [[nodiscard]] Program& program(const std::string& path) { return programs_[path]; }
    /// The same of a file of labels, whose types are not only those that a program declares.
    [[nodiscard]] Labels& labels(const std::string& path) { return labels_[path]; }
    /// The PLC that was found possible last; null if there was none.
    [[nodiscard]] std::shared_ptr<const PlcTrial>& tried() { return tried_; }

private:
    using Programs = std::map<std::string, Program, std::less<>>;

    Texts texts_;
    /// See again().
    Texts texts_before_;
    /// It was made with all there is to a configuration.
    bool has_all_{false};
    std::string received_place_;
    /// Of texts, and of those before.
    Programs programs_;
    std::map<std::string, Labels, std::less<>> labels_;
    std::shared_ptr<const PlcTrial> tried_;
};

} // namespace busbar::product
