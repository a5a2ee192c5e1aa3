#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/controller/program_image.hpp>
#include <busbar/controller/program_types.hpp>
#include <busbar/core/api.hpp>

namespace busbar::controller {

/// The types that a program of labels may use without declaring them.
///
/// TIMER, RETENTIVETIMER, COUNTER are structures of S and C, which are BOOL, and N, a UINT;
/// LTIMER, LRETENTIVETIMER, LCOUNTER have a UDINT N. An array of UTF16_UNIT, which is a UINT, is a
/// text of UTF-16 (WSTRING) with one character less than its last dimension, for the zero.
[[nodiscard]] BUSBAR_API std::vector<DerivedType> label_types();

/// A program whose global variables are labels (seed 001, 8.2 and 8.3), with memory for them: a
/// ProgramImage of all but what unions are in, so that a Plc's programs can run on it.
///
/// Which label a variable is: BOOL Bit, INT Word, UINT and WORD UnsignedWord, DINT and enumerations
/// DoubleWord, UDINT and DWORD UnsignedDoubleWord, REAL Float, LREAL Double, TIME Time, STRING
/// String, arrays of UTF16_UNIT UnicodeString, and what label_types() has. A STRING's bytes are
/// taken as they are: who wants the clients' character set in it puts CP932 there. All other types
/// are unsupported.
///
/// Not accessible are variables that are not published, and members of structures at an address;
/// CONSTANT ones are no labels. Elements are counted from the lower bound of their declaration.
class BUSBAR_API LabelProgram {
    struct Key {};

public:
    /// `program` is without label_types(); a type of its own of one of those names is a Problem.
    [[nodiscard]] static Configured<std::shared_ptr<LabelProgram>>
    create(Program program,
           const server::ImageOptions& options = {.max_pins = 1, .max_queued_scans = 1});
    LabelProgram(Key, Program program);
    LabelProgram(const LabelProgram&) = delete;
    LabelProgram& operator=(const LabelProgram&) = delete;
    ~LabelProgram();

    /// Those of the program, with label_types().
    [[nodiscard]] const ProgramTypes& types() const { return *types_; }
    /// For Plc::create.
    [[nodiscard]] const ProgramImage& image() const { return *image_; }
    /// What the PLC's thread works in.
    [[nodiscard]] server::ImageMemory& memory() const { return image_->image()->memory(); }
    /// Null if there is none of this name; case does not count.
    [[nodiscard]] const GlobalVariable* variable(std::string_view name) const;
    /// The handle in memory() of one of the program's variables; none if a union is in it.
    [[nodiscard]] std::optional<std::uint32_t> handle_of(const GlobalVariable& variable) const;

private:
    [[nodiscard]] std::optional<Problem> make(const server::ImageOptions& options);

    Program program_;
    std::optional<ProgramTypes> types_;
    std::optional<ProgramImage> image_;
    /// By the name as fold_name has it: the index of the variable.
    std::unordered_map<std::string, std::size_t> by_name_;
    /// By the variable's index.
    std::vector<std::optional<std::uint32_t>> handles_;
};

} // namespace busbar::controller
