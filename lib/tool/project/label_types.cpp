#include <busbar/controller/label_check.hpp>

#include "commands.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::project {

namespace {

using controller::Assignability;
using controller::LeafType;

void append_to(std::string& list, std::string_view text)
{
    list += (list.empty() ? "" : ", ") + std::string{text};
}

/// The row of the tables "Data types of labels" (SH-082679, 8.2).
void add_type(const controller::DeclaredLabelType& declared, Table& table, JsonLine& json)
{
    controller::LabelTypes types;
    const auto add_leaf = [&](LeafType leaf, std::string_view name) {
        const Assignability found = controller::assignability(leaf, declared.type, declared.part);
        if (found != Assignability::No) {
            append_to(found == Assignability::Same ? types.same : types.checked, name);
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

Exit list_label_types(Context& context, const ProjectArguments&)
{
    JsonLine json;
    json.open_array();
    Table table{{{"DECLARED AS", 26}, {"SAME VALUES", 14}, {"IF IN RANGE", 24}}};
    for (const controller::DeclaredLabelType& declared : controller::declared_label_types()) {
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
