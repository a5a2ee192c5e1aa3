#include "gx_table.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "constant_table.hpp"
#include "core/ascii_case.hpp"
#include "declaration_cursor.hpp"
#include "declaration_parser.hpp"
#include "enumerator_numbers.hpp"
#include "initial_reader.hpp"
#include "literal.hpp"
#include "program_problem.hpp"
#include "text_places.hpp"

namespace busbar::controller::detail {

namespace {

using busbar::detail::is_same_ignoring_case;

struct GxColumn {
    enum Value : std::size_t {
        Class,
        Named,
        Typed,
        Constant,
        Initial,
        Assigned,
        Address,
        Comment,
        External
    };
    static constexpr std::size_t count = 9;
};
constexpr std::size_t max_cells = 64;

struct GxTitle {
    GxColumn::Value column;
    std::string_view text;
};
/// The titles of both tools, in English and in Japanese.
constexpr std::array gx_titles{
    GxTitle{GxColumn::Class, "Class"},
    GxTitle{GxColumn::Class, "クラス"},
    GxTitle{GxColumn::Named, "Label Name"},
    GxTitle{GxColumn::Named, "ラベル名"},
    GxTitle{GxColumn::Typed, "Data Type"},
    GxTitle{GxColumn::Typed, "データ型"},
    GxTitle{GxColumn::Constant, "Constant"},
    GxTitle{GxColumn::Constant, "定数"},
    GxTitle{GxColumn::Constant, "定数値"},
    GxTitle{GxColumn::Initial, "Initial Value"},
    GxTitle{GxColumn::Initial, "初期値"},
    GxTitle{GxColumn::Assigned, "Device"},
    GxTitle{GxColumn::Assigned, "デバイス"},
    GxTitle{GxColumn::Assigned, "Assign (Device/Label)"},
    GxTitle{GxColumn::Assigned, "割付(デバイス/ラベル)"},
    GxTitle{GxColumn::Address, "Address"},
    GxTitle{GxColumn::Address, "アドレス"},
    GxTitle{GxColumn::Comment, "Comment"},
    GxTitle{GxColumn::Comment, "コメント"},
    GxTitle{GxColumn::External, "Access from External Device"},
    GxTitle{GxColumn::External, "外部機器からのアクセス"},
};

struct GxTypeName {
    std::string_view text;
    std::string_view iec;
};
/// The names of types in both languages; names of IEC 61131-3 are used as well.
constexpr std::array gx_type_names{
    GxTypeName{"Bit", "BOOL"},
    GxTypeName{"ビット", "BOOL"},
    GxTypeName{"Word [Signed]", "INT"},
    GxTypeName{"ワード[符号付き]", "INT"},
    GxTypeName{"Word [Unsigned]/Bit String [16-bit]", "WORD"},
    GxTypeName{"ワード[符号なし]/ビット列[16ビット]", "WORD"},
    GxTypeName{"Double Word [Signed]", "DINT"},
    GxTypeName{"ダブルワード[符号付き]", "DINT"},
    GxTypeName{"Double Word [Unsigned]/Bit String [32-bit]", "DWORD"},
    GxTypeName{"ダブルワード[符号なし]/ビット列[32ビット]", "DWORD"},
    GxTypeName{"FLOAT [Single Precision]", "REAL"},
    GxTypeName{"単精度実数", "REAL"},
    GxTypeName{"FLOAT [Double Precision]", "LREAL"},
    GxTypeName{"倍精度実数", "LREAL"},
    GxTypeName{"Time", "TIME"},
    GxTypeName{"時間", "TIME"},
    GxTypeName{"String", "STRING"},
    GxTypeName{"文字列", "STRING"},
    GxTypeName{"String [Unicode]", "WSTRING"},
    GxTypeName{"文字列[Unicode]", "WSTRING"},
    GxTypeName{"Timer", "TIMER"},
    GxTypeName{"タイマ", "TIMER"},
    GxTypeName{"Retentive Timer", "RETENTIVETIMER"},
    GxTypeName{"積算タイマ", "RETENTIVETIMER"},
    GxTypeName{"Counter", "COUNTER"},
    GxTypeName{"カウンタ", "COUNTER"},
    GxTypeName{"Long Timer", "LTIMER"},
    GxTypeName{"ロングタイマ", "LTIMER"},
    GxTypeName{"Long Retentive Timer", "LRETENTIVETIMER"},
    GxTypeName{"ロング積算タイマ", "LRETENTIVETIMER"},
    GxTypeName{"Long Counter", "LCOUNTER"},
    GxTypeName{"ロングカウンタ", "LCOUNTER"},
};

/// A line's cells without their quotes, and its end.
struct GxLine {
    std::vector<std::string> cells{};
    std::size_t end{0};
};

/// Cuts the line that begins there; between quotes a line may have line feeds.
GxLine line_at(std::string_view text, std::size_t begin, char separator)
{
    GxLine line{.cells = {std::string{}}, .end = begin};
    bool is_quoted = false;
    for (; line.end < text.size(); ++line.end) {
        const char c = text[line.end];
        const bool is_quote = c == '"';
        if (is_quoted && is_quote && text.substr(line.end + 1, 1) == "\"") {
            line.cells.back() += c;
            ++line.end;
        } else if (is_quote) {
            is_quoted = !is_quoted;
        } else if (!is_quoted && c == '\n') {
            break;
        } else if (!is_quoted && c == separator) {
            if (line.cells.size() < max_cells) {
                line.cells.emplace_back();
            }
        } else if (c != '\r') {
            line.cells.back() += c;
        }
    }
    for (std::string& cell : line.cells) {
        cell = trimmed_text(cell);
    }
    return line;
}

/// Where the columns are, and where the lines after the titles begin.
struct GxLayout {
    std::array<std::size_t, GxColumn::count> places{};
    std::size_t begin{0};
    char separator{'\t'};

    [[nodiscard]] std::string_view cell(const GxLine& line, GxColumn::Value column) const
    {
        const std::size_t place = places[column];
        return place < line.cells.size() ? std::string_view{line.cells[place]} : std::string_view{};
    }
    [[nodiscard]] bool has(GxColumn::Value column) const { return places[column] != max_cells; }
};

/// Finds the titles in one of the first lines; before them is the name of the project.
std::optional<GxLayout> layout_of(std::string_view text)
{
    constexpr std::size_t most_lines = 4;
    constexpr std::size_t longest = 4'096;
    for (const char separator : {'\t', ','}) {
        GxLayout layout{.separator = separator};
        for (std::size_t i = 0; i < most_lines && layout.begin < text.size(); ++i) {
            const GxLine line =
                line_at(text.substr(0, layout.begin + longest), layout.begin, separator);
            layout.begin = line.end + 1;
            layout.places.fill(max_cells);
            for (const GxTitle& title : gx_titles) {
                const auto found = std::ranges::find_if(line.cells, [&](const std::string& cell) {
                    return is_same_ignoring_case(cell, title.text);
                });
                if (found != line.cells.end()) {
                    layout.places[title.column] =
                        static_cast<std::size_t>(found - line.cells.begin());
                }
            }
            if (layout.has(GxColumn::Named) && layout.has(GxColumn::Typed)) {
                return layout;
            }
        }
    }
    return {};
}

/// Writes a type as declarations have it: "Word [Signed](0..9)" is ARRAY [0..9] OF INT, and
/// "String(32)" is STRING[32].
std::string iec_type(std::string_view text)
{
    const std::size_t open = text.ends_with(')') ? text.rfind('(') : text.npos;
    const std::string_view name = trimmed_text(text.substr(0, open));
    const std::string_view inner =
        open == text.npos ? std::string_view{} : text.substr(open + 1, text.size() - open - 2);
    const bool is_array = inner.find("..") != inner.npos;
    if (is_array) {
        return "ARRAY [" + std::string{inner} + "] OF " + iec_type(name);
    }
    const auto* const found = std::ranges::find_if(gx_type_names, [&](const GxTypeName& each) {
        return is_same_ignoring_case(each.text, name);
    });
    if (found == gx_type_names.end()) {
        return std::string{text};
    }
    return std::string{found->iec} + (inner.empty() ? "" : "[" + std::string{inner} + "]");
}

/// Writes a constant as declarations have it: K10 is 10, H1F is 16#1F and E1.5 is 1.5.
std::string iec_constant(std::string_view text)
{
    const std::string_view rest = text.substr(std::min<std::size_t>(text.size(), 1));
    const bool is_number =
        !rest.empty() && rest.find_first_not_of("0123456789ABCDEFabcdef+-.") == rest.npos;
    if (is_number && (text.front() == 'K' || text.front() == 'E')) {
        return std::string{rest};
    }
    return is_number && text.front() == 'H' ? "16#" + std::string{rest} : std::string{text};
}

class GxReader {
public:
    GxReader(std::string_view text, std::string_view file_name, const GxLayout& layout,
             const TextPlaces& places, const DeclarationLimits& limits, ConstantTable& constants,
             Unserved unserved)
        : text_{text}, file_name_{file_name}, layout_{&layout}, places_{&places}, limits_{&limits},
          memory_{limits.max_memory}, constants_{&constants}, unserved_{unserved}
    {
    }

    Configured<Program> read()
    {
        for (std::size_t begin = layout_->begin; begin < text_.size();) {
            const GxLine line = line_at(text_, begin, layout_->separator);
            place_ = places_->at(begin);
            if (!layout_->cell(line, GxColumn::Named).empty() && !read_line(line) &&
                !leave_out(line)) {
                return Unexpected<Problem>{
                    Problem{.where = place_text(file_name_, place_), .text = problem_}};
            }
            begin = line.end + 1;
        }
        return std::move(program_);
    }

private:
    bool fail(std::string text)
    {
        problem_ = std::move(text);
        return false;
    }

    bool keep(std::size_t bytes)
    {
        is_exhausted_ = is_exhausted_ || !memory_.take(bytes);
        return !is_exhausted_ || fail("takes more than " + std::to_string(limits_->max_memory) +
                                      " bytes of memory up to here");
    }

    /// Lets `read` read a whole text as part of a declaration.
    template <typename Read>
    bool read_text(std::string_view text, Read read)
    {
        DeclarationCursor cursor{text, {}, nullptr, *limits_, memory_, *constants_};
        if (read(cursor) && (cursor.is_end() || cursor.fail("the end of the cell"))) {
            return true;
        }
        is_exhausted_ = is_exhausted_ || !cursor.can_recover();
        return fail(cursor.recover().first);
    }

    bool read_class(std::string_view text, GlobalVariable& variable)
    {
        variable.is_constant = is_same_ignoring_case(text, "VAR_GLOBAL_CONSTANT");
        variable.is_retained = is_same_ignoring_case(text, "VAR_GLOBAL_RETAIN");
        return variable.is_constant || variable.is_retained || text.empty() ||
               is_same_ignoring_case(text, "VAR_GLOBAL") ||
               fail(found_expected(text, "VAR_GLOBAL, VAR_GLOBAL_CONSTANT or VAR_GLOBAL_RETAIN; "
                                         "other classes are those of local labels"));
    }

    bool read_line(const GxLine& line)
    {
        const std::string_view name = layout_->cell(line, GxColumn::Named);
        const std::string_view comment = layout_->cell(line, GxColumn::Comment);
        const std::string_view device = layout_->cell(line, GxColumn::Assigned);
        GlobalVariable variable;
        variable.place = place_;
        const auto read_name = [&](DeclarationCursor& cursor) {
            return cursor.expect_name(variable.name, "the name of a label");
        };
        const auto read_type = [&](DeclarationCursor& cursor) {
            return read_type_use(cursor, unserved_, variable.type);
        };
        const auto read_value = [&](DeclarationCursor& cursor) {
            return read_initial_value(cursor, variable.initial);
        };
        const std::string type = iec_type(layout_->cell(line, GxColumn::Typed));
        if (!keep(sizeof variable + comment.size() + device.size()) ||
            !read_class(layout_->cell(line, GxColumn::Class), variable) ||
            !read_text(name, read_name) || !read_text(type, read_type)) {
            return false;
        }
        const std::string_view constant = layout_->cell(line, GxColumn::Constant);
        const std::string value =
            iec_constant(constant.empty() ? layout_->cell(line, GxColumn::Initial) : constant);
        if (!value.empty() && !read_text(value, read_value)) {
            return false;
        }
        variable.publish = publish_of_line(line);
        const std::string_view address = layout_->cell(line, GxColumn::Address);
        variable.address = (device.empty() ? address : device).substr(0, limits_->max_name_length);
        variable.comment = comment;
        program_.variables.push_back(std::move(variable));
        return true;
    }

    [[nodiscard]] NetworkPublish publish_of_line(const GxLine& line) const
    {
        const std::string_view external = layout_->cell(line, GxColumn::External);
        return external == "1" || is_same_ignoring_case(external, "TRUE")
                   ? NetworkPublish::PublishOnly
                   : NetworkPublish::Hidden;
    }

    bool leave_out(const GxLine& line)
    {
        const std::string_view name =
            layout_->cell(line, GxColumn::Named).substr(0, limits_->max_name_length);
        if (unserved_ == Unserved::Refuse || is_exhausted_ ||
            !keep(sizeof(LeftOut) + problem_.size() + 2 * name.size())) {
            return false;
        }
        program_.left_out.push_back(left_out(LeftOut::Kind::Variable, std::string{name},
                                             publish_of_line(line), place_, problem_));
        return true;
    }

    std::string_view text_;
    std::string_view file_name_;
    const GxLayout* layout_;
    const TextPlaces* places_;
    const DeclarationLimits* limits_;
    MemoryBudget memory_;
    ConstantTable* constants_;
    Unserved unserved_;
    Program program_{};
    std::string problem_{};
    ProgramPlace place_{};
    bool is_exhausted_{false};
};

} // namespace

bool is_gx_table(std::string_view text)
{
    return layout_of(text).has_value();
}

Configured<Program> read_gx_table(std::string_view text, std::string_view file_name,
                                  const DeclarationLimits& limits, Unserved unserved)
{
    const auto layout = layout_of(text);
    if (!layout) {
        return misconfigured(std::string{file_name},
                             "found no line with the titles Label Name and Data Type");
    }
    const TextPlaces places{text};
    ConstantTable constants;
    constants.set_file(file_name);
    auto program = read_in_passes(constants, unserved, [&](Unserved choice) {
        return GxReader{text, file_name, *layout, places, limits, constants, choice}.read();
    });
    if (program) {
        settle_enumerators(*program);
    }
    return program;
}

} // namespace busbar::controller::detail
