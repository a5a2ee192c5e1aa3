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

/// Returns the types that a program of labels may use without declaring them.
///
/// TIMER, RETENTIVETIMER, COUNTER are structures of S and C, which are BOOL, and N, a UINT; LTIMER,
/// LRETENTIVETIMER, LCOUNTER have a UDINT N. An array of UTF16_UNIT, which is a UINT, is a UTF-16
/// text (WSTRING) with one character less than its last dimension, for the zero.
[[nodiscard]] BUSBAR_API std::vector<DerivedType> label_types();

/// A program whose global variables are labels (SH-082679, 8.2 and 8.3), with memory for
/// them: a ProgramImage of all except those that contain unions, on which a Plc's programs can run.
///
/// The type of label of each variable: BOOL Bit, INT Word, UINT and WORD UnsignedWord, DINT and
/// enumerations DoubleWord, UDINT and DWORD UnsignedDoubleWord, REAL Float, LREAL Double, TIME
/// Time, STRING String, WSTRING and arrays of UTF16_UNIT UnicodeString, and the types of
/// label_types(). A STRING's bytes are used unchanged: they should be CP932 if clients are to see
/// its characters. All other types are unsupported: the manual has no labels of 8 and of 64 bits,
/// to which LTIME and dates would belong. types() has each WSTRING as an array of UTF16_UNIT.
///
/// Variables that are not published, and members of structures at an address, are not accessible;
/// CONSTANT ones are not labels. Elements are counted from the lower bound of their declaration.
class BUSBAR_API LabelProgram {
    struct Key {};

public:
    /// `program` is without label_types(); if it declares a type with one of those names, that is a
    /// Problem. With Unserved::LeaveOut a declaration with a problem, or a type with one of those
    /// names, is left out; its variables are not labels.
    [[nodiscard]] static Configured<std::shared_ptr<LabelProgram>>
    create(Program program, Unserved unserved = Unserved::Refuse,
           const server::ImageOptions& options = {.max_pins = 1, .max_queued_scans = 1});
    /// Moves to Program::left_out what create() leaves out with Unserved::LeaveOut. Takes time in
    /// proportion to the program.
    static void leave_out(Program& program);
    LabelProgram(Key, Program program);
    LabelProgram(const LabelProgram&) = delete;
    LabelProgram& operator=(const LabelProgram&) = delete;
    ~LabelProgram();

    /// The types of the program, including label_types().
    [[nodiscard]] const ProgramTypes& types() const { return *types_; }
    /// For Plc::create.
    [[nodiscard]] const ProgramImage& image() const { return *image_; }
    /// The memory that the PLC's thread works in.
    [[nodiscard]] server::ImageMemory& memory() const { return image_->image()->memory(); }
    /// Returns null if there is no variable with this name; case is ignored.
    [[nodiscard]] const GlobalVariable* variable(std::string_view name) const;
    /// Returns the handle in memory() of one of the program's variables; none if it contains a
    /// union.
    [[nodiscard]] std::optional<std::uint32_t> handle_of(const GlobalVariable& variable) const;

private:
    [[nodiscard]] std::optional<Problem> make(const server::ImageOptions& options);

    Program program_;
    std::optional<ProgramTypes> types_;
    std::optional<ProgramImage> image_;
    /// The index of the variable, keyed by the name as fold_name returns it.
    std::unordered_map<std::string, std::size_t> by_name_;
    /// Indexed like the variables.
    std::vector<std::optional<std::uint32_t>> handles_;
};

} // namespace busbar::controller
