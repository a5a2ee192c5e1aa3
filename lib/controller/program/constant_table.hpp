#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <busbar/controller/program.hpp>

#include "expression.hpp"

namespace busbar::controller::detail {

/// Limits in sum over all expressions of a program.
struct ExpressionLimits {
    /// A step is an operand or an operator, or 64 bytes of a text.
    std::size_t max_steps{50'000'000};
    /// Parentheses, arguments and constants within one another.
    std::size_t max_depth{100};
    /// In bytes.
    std::size_t max_text{65'536};
};

/// The constants and values of enumerations that a program declares, each with the text of its
/// expression, which is computed when it is first used.
///
/// A program that uses names before it declares them is read in passes: in the first one, names
/// that are not there yet are Later, and needs_pass() says so. After complete() every name is
/// known or Missing. The texts of expressions and the names of files must outlive the table.
class BUSBAR_API ConstantTable {
public:
    explicit ConstantTable(const ExpressionLimits& limits = {})
        : limits_{limits}, steps_left_{limits.max_steps}
    {
    }

    [[nodiscard]] const ExpressionLimits& limits() const { return limits_; }

    /// The bytes that a name takes, for a MemoryBudget.
    static constexpr std::size_t memory_of_one = 512;

    /// The contents of a declaration; `place` is of the file that was set.
    struct Declared {
        std::string_view name{};
        /// The expression; empty: none.
        std::string_view text{};
        ProgramPlace place{};
    };
    /// Sets the file and the list of variables, such as a GVL, of the following declarations.
    void set_file(std::string_view file) { file_ = file; }
    void set_list(std::string_view name) { list_ = name; }
    /// Adds a constant of that type. The first one of a name counts.
    void add_constant(const Declared& declared, const TypeUse& type);
    /// Starts the values of an enumeration; within it, their names come first.
    void begin_enumeration(std::string_view name);
    /// Without an expression it is the value before it, plus 1.
    void add_enumerator(const Declared& declared);
    void end_enumeration() { context_.clear(); }

    /// Finds the value of a name such as `Gvl.N`, given as its parts. If it depends on something
    /// wrong, gives false after reporting that at `offset` of the cursor.
    [[nodiscard]] bool find(DeclarationCursor& cursor, const std::vector<std::string_view>& parts,
                            std::size_t offset, ExpressionValue& value);
    /// Finds the size of a declared type. Later if it is not known yet.
    [[nodiscard]] ExpressionValue::State size_of(std::string_view type, std::uint64_t& size);

    /// Takes steps from the budget; false if there are too few.
    [[nodiscard]] bool take_steps(std::size_t count);
    /// One level of parentheses or names within one another; leave() must follow if it gives true.
    [[nodiscard]] bool enter() { return depth_ < limits_.max_depth && ++depth_ > 0; }
    void leave() { --depth_; }

    /// True if something was Later, so that the program has to be read again.
    [[nodiscard]] bool needs_pass() const { return needs_pass_; }
    /// Number of uses of something that was not known yet.
    [[nodiscard]] std::size_t later_count() const { return later_count_; }
    /// A type of this name has something that was not known yet.
    void add_unsettled(const std::string& type) { unsettled_.insert(type); }
    /// Prepares the next pass after all names were read; `program` is what was read. In the last
    /// pass sizes that are still not known are Missing.
    void complete(const Program& program, bool is_last);

private:
    enum class State : std::uint8_t { Unread, Reading, Later, Known, Wrong };
    struct Entry {
        std::string name{};
        std::string_view text{};
        std::string_view file{};
        ProgramPlace place{};
        /// For a value of an enumeration.
        std::string enumeration{};
        /// For a value without an expression: the entry that it counts from, and how far it is.
        std::size_t base{none};
        std::int64_t distance{0};
        /// The type of a constant.
        std::optional<ElementaryType> type{};
        bool is_enumerator{false};
        State state{State::Unread};
        ExpressionValue value{};
        std::string problem{};
    };
    static constexpr std::size_t none = SIZE_MAX;
    static constexpr std::size_t ambiguous = SIZE_MAX - 1;

    void add_name(const Entry& entry, const std::string& folded, std::size_t index);
    [[nodiscard]] std::size_t index_of(const std::vector<std::string_view>& parts) const;
    [[nodiscard]] std::size_t at(const std::unordered_map<std::string, std::size_t>& map,
                                 const std::string& key) const;
    /// Computes an entry that is Unread.
    void compute(DeclarationCursor& by, std::size_t index);
    void compute_text(DeclarationCursor& by, std::size_t index);
    void compute_distance(DeclarationCursor& by, std::size_t index);
    void settle(std::size_t index, ExpressionValue value);
    void fail(std::size_t index, std::string problem, const std::string& where);
    /// Describes the entries that depend on each other.
    [[nodiscard]] std::string cycle_words(std::size_t index) const;
    [[nodiscard]] std::string place_words(std::size_t index) const;

    ExpressionLimits limits_;
    std::size_t steps_left_;
    std::size_t depth_{0};
    bool is_complete_{false};
    bool is_last_{false};
    bool needs_pass_{false};
    bool wants_sizes_{false};
    std::size_t later_count_{0};
    std::string_view file_{};
    std::string_view list_{};
    /// The folded name of the enumeration whose values are being read.
    std::string context_{};
    std::size_t last_explicit_{none};
    std::int64_t distance_{0};
    std::vector<Entry> entries_{};
    std::vector<std::size_t> reading_{};
    /// Indices of entries; `ambiguous` if several enumerations have the name.
    std::unordered_map<std::string, std::size_t> by_name_{};
    /// Keyed by "gvl.n".
    std::unordered_map<std::string, std::size_t> by_qualified_{};
    std::unordered_set<std::string> enumerations_{};
    std::unordered_set<std::string> unsettled_{};
    std::unordered_map<std::string, std::uint64_t> sizes_{};
};

/// Reads a program in as many passes as its names need. `read` reads all of it once.
template <typename Read>
[[nodiscard]] Configured<Program> read_in_passes(ConstantTable& constants, Unserved unserved,
                                                 Read read)
{
    constexpr int most = 3;
    Configured<Program> program = read(unserved);
    if (!constants.needs_pass()) {
        return program;
    }
    if (unserved == Unserved::Refuse) {
        // Find the declarations after what may be no mistake.
        program = read(Unserved::LeaveOut);
    }
    for (int pass = 2; pass <= most && constants.needs_pass(); ++pass) {
        constants.complete(program ? *program : Program{}, pass == most);
        program = Program{}; // does not need the memory of both
        program = read(unserved);
    }
    return program;
}

} // namespace busbar::controller::detail
