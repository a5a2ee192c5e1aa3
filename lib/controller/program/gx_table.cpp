#include "cell_table.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "core/ascii_case.hpp"
#include "literal.hpp"

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

/// Says where the columns are, and where the lines after the titles begin.
struct GxLayout {
    std::array<std::size_t, GxColumn::count> places{};
    std::size_t begin{0};
    TableForm form{.separator = '\t', .has_quotes = true};
    /// The only cell of the line before the titles; empty if there is none.
    std::string heading{};

    [[nodiscard]] const TableCell& cell(const TableLine& line, GxColumn::Value column) const
    {
        static const TableCell none{};
        const std::size_t place = places[column];
        return place < line.cells.size() ? line.cells[place] : none;
    }
    [[nodiscard]] bool has(GxColumn::Value column) const
    {
        return places[column] != max_table_cells;
    }
};

/// Finds the titles in a line.
void find_titles(const TableLine& line, GxLayout& layout)
{
    layout.places.fill(max_table_cells);
    for (const GxTitle& title : gx_titles) {
        const auto found = std::ranges::find_if(line.cells, [&](const TableCell& cell) {
            return is_same_ignoring_case(cell.text, title.text);
        });
        if (found != line.cells.end()) {
            layout.places[title.column] = static_cast<std::size_t>(found - line.cells.begin());
        }
    }
}

/// Finds the titles in one of the first lines; before them is the name of the project, or of a
/// structure.
std::optional<GxLayout> layout_of(std::string_view text)
{
    constexpr std::size_t most_lines = 4;
    constexpr std::size_t longest = 4'096;
    for (const char separator : {'\t', ','}) {
        GxLayout layout;
        layout.form.separator = separator;
        for (std::size_t i = 0; i < most_lines && layout.begin < text.size(); ++i) {
            const TableLine line =
                table_line(text.substr(0, layout.begin + longest), layout.begin, layout.form);
            layout.begin = line.end + 1;
            find_titles(line, layout);
            if (layout.has(GxColumn::Named) && layout.has(GxColumn::Typed)) {
                return layout;
            }
            layout.heading = line.cells.size() == 1 ? line.cells.front().text : std::string{};
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

NetworkPublish publish_of_line(std::string_view external)
{
    return external == "1" || is_same_ignoring_case(external, "TRUE") ? NetworkPublish::PublishOnly
                                                                      : NetworkPublish::Hidden;
}

TableRow gx_row(const GxLayout& layout, const TableLine& line)
{
    TableRow row{.name = layout.cell(line, GxColumn::Named),
                 .type = layout.cell(line, GxColumn::Typed),
                 .initial = layout.cell(line, GxColumn::Constant)};
    row.type.text = iec_type(row.type.text);
    if (row.initial.text.empty()) {
        row.initial = layout.cell(line, GxColumn::Initial);
    }
    row.initial.text = iec_constant(row.initial.text);
    const TableCell& group = layout.cell(line, GxColumn::Class);
    const std::string& device = layout.cell(line, GxColumn::Assigned).text;
    GlobalVariable& variable = row.variable;
    variable.is_constant = is_same_ignoring_case(group.text, "VAR_GLOBAL_CONSTANT");
    variable.is_retained = is_same_ignoring_case(group.text, "VAR_GLOBAL_RETAIN");
    variable.address = device.empty() ? layout.cell(line, GxColumn::Address).text : device;
    variable.comment = layout.cell(line, GxColumn::Comment).text;
    variable.publish = publish_of_line(layout.cell(line, GxColumn::External).text);
    const bool is_global = variable.is_constant || variable.is_retained || group.text.empty() ||
                           is_same_ignoring_case(group.text, "VAR_GLOBAL");
    if (!is_global) {
        row.problem = found_expected(group.text, "VAR_GLOBAL, VAR_GLOBAL_CONSTANT or "
                                                 "VAR_GLOBAL_RETAIN; other classes are those of "
                                                 "local labels");
        row.problem_offset = group.offset;
    }
    return row;
}

/// Returns the name of a file without its folder and its ending.
std::string stem_of(std::string_view file)
{
    file.remove_prefix(std::min(file.size(), file.find_last_of("/\\") + 1));
    return std::string{file.substr(0, file.rfind('.'))};
}

} // namespace

bool is_gx_table(std::string_view text)
{
    return layout_of(text).has_value();
}

Configured<void> add_gx_table(const SourceText& source, ProgramParts& to)
{
    auto layout = layout_of(source.text);
    if (!layout) {
        return misconfigured(std::string{source.file},
                             "found no line with the titles Label Name and Data Type");
    }
    // A list of a structure's members has no classes.
    std::string structure;
    if (!layout->has(GxColumn::Class)) {
        structure = layout->heading.empty() ? stem_of(source.file) : layout->heading;
    }
    CellTable table{
        .form = layout->form, .begin = layout->begin, .structure = std::move(structure)};
    table.row_of = [layout = *std::move(layout)](const TableLine& line) {
        return gx_row(layout, line);
    };
    add_table(source, std::move(table), to);
    return {};
}

} // namespace busbar::controller::detail
