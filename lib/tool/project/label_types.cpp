#include "label_types.hpp"

#include <array>

#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::project {

namespace {

using controller::Assignability;
using controller::LeafType;

/// Types that a program declares labels with, see controller::LabelProgram.
struct DeclaredType {
    const char* text;
    backend::LabelType type;
    backend::TimerPart part{backend::TimerPart::None};
};

constexpr std::array declared_types{
    DeclaredType{"BOOL", backend::LabelType::Bit},
    DeclaredType{"UINT, WORD", backend::LabelType::UnsignedWord},
    DeclaredType{"UDINT, DWORD", backend::LabelType::UnsignedDoubleWord},
    DeclaredType{"INT", backend::LabelType::Word},
    DeclaredType{"DINT", backend::LabelType::DoubleWord},
    DeclaredType{"REAL", backend::LabelType::Float},
    DeclaredType{"LREAL", backend::LabelType::Double},
    DeclaredType{"TIME", backend::LabelType::Time},
    DeclaredType{"STRING(n)", backend::LabelType::String},
    DeclaredType{"ARRAY[0..n] OF UTF16_UNIT", backend::LabelType::UnicodeString},
    DeclaredType{"any timer or counter .S", backend::LabelType::Timer, backend::TimerPart::Contact},
    DeclaredType{"any timer or counter .C", backend::LabelType::Timer, backend::TimerPart::Coil},
    DeclaredType{"TIMER, RETENTIVETIMER .N", backend::LabelType::Timer,
                 backend::TimerPart::Current},
    DeclaredType{"LTIMER, LRETENTIVETIMER .N", backend::LabelType::LongTimer,
                 backend::TimerPart::Current},
    DeclaredType{"COUNTER .N", backend::LabelType::Counter, backend::TimerPart::Current},
    DeclaredType{"LCOUNTER .N", backend::LabelType::LongCounter, backend::TimerPart::Current},
};

void append_to(std::string& list, const char* separator, std::string_view text)
{
    list += (list.empty() ? "" : separator) + std::string{text};
}

/// The row of the tables "Data types of labels" (seed 001, 8.2).
void add_type(const DeclaredType& declared, Table& table, JsonLine& json)
{
    LabelTypes types;
    const auto add_leaf = [&](LeafType leaf, std::string_view name) {
        const Assignability found = controller::assignability(leaf, declared.type, declared.part);
        if (found != Assignability::No) {
            append_to(found == Assignability::Same ? types.same : types.checked, ", ", name);
        }
    };
    for (std::size_t type = 1; type <= last_built_in_type; ++type) {
        add_leaf({static_cast<BuiltInType>(type)}, name(static_cast<BuiltInType>(type)));
    }
    add_leaf({BuiltInType::Int32, true}, "Enumeration");
    table.add({{declared.text}, {types.same}, {types.checked}});
    json.open_object().member("declaredAs", declared.text).member("same", types.same);
    json.member("checked", types.checked).close_object();
}

} // namespace

LabelTypes label_types_for(const controller::MappablePart& part)
{
    LabelTypes types;
    for (const DeclaredType& declared : declared_types) {
        const Assignability found =
            part.path == "Handle" // of a Method
                ? (controller::is_handle_label(declared.type) ? Assignability::Same
                                                              : Assignability::No)
                : controller::assignability(part.leaf, declared.type, declared.part);
        if (found != Assignability::No) {
            append_to(found == Assignability::Same ? types.same : types.checked, "; ",
                      declared.text);
        }
    }
    return types;
}

Exit list_label_types(Context& context, const ProjectArguments&)
{
    JsonLine json;
    json.open_array();
    Table table{{{"DECLARED AS", 26}, {"SAME VALUES", 14}, {"IF IN RANGE", 24}}};
    for (const DeclaredType& declared : declared_types) {
        add_type(declared, table, json);
    }
    if (context.options.is_json) {
        context.out.line(json.close_array().document());
    } else {
        table.print(context.out);
        context.out.line("The Handle of a Method is a UINT or WORD.");
    }
    return Exit::Good;
}

} // namespace busbar::tool::project
