#include <busbar/controller/program_types.hpp>

#include "controller/program/declaration_keywords.hpp"
#include "controller/program/declaration_parser.hpp"
#include "plcopen_reader.hpp"

namespace busbar::controller::detail {

std::string_view specification_of(const pugi::xml_node& xml)
{
    constexpr std::string_view name = "type";
    for (const pugi::xml_attribute& attribute : xml.attributes()) {
        const std::string_view found = attribute.name();
        if (found.ends_with(name) &&
            (found.size() == name.size() || found[found.size() - name.size() - 1] == ':')) {
            const std::string_view value = attribute.value();
            return value.substr(value.find(':') == value.npos ? 0 : value.find(':') + 1);
        }
    }
    return {};
}

bool is_array_specification(const pugi::xml_node& xml)
{
    return is_named(xml, "instantlyDefinedType") && specification_of(xml) == "ArrayTypeSpec";
}

bool PlcopenReader::read_declared_type(const pugi::xml_node& xml)
{
    DerivedType type{.name = {}, .place = place_of(xml)};
    const std::size_t later = pass_->constants.later_count();
    const pugi::xml_node specification = child_of(xml, "userDefinedTypeSpec");
    if (!keep(xml, sizeof type) || !read_name(xml, "name", type.name)) {
        return false;
    }
    if (!specification) {
        return fail(xml, "found " + tag_of(xml) + ", expected a <UserDefinedTypeSpec> in it");
    }
    if (!read_specification(specification, type) || !read_initial(xml, type.initial) ||
        !read_documentation(xml, type.comment)) {
        return false;
    }
    if (pass_->constants.later_count() != later) {
        pass_->constants.add_unsettled(fold_name(type.name));
    }
    pass_->program.types.push_back(std::move(type));
    return true;
}

bool PlcopenReader::read_specification(const pugi::xml_node& xml, DerivedType& type)
{
    const std::string_view kind = specification_of(xml);
    if (kind.starts_with("Struct") || kind.starts_with("Union")) {
        type.kind =
            kind.starts_with("Struct") ? DerivedType::Kind::Structure : DerivedType::Kind::Union;
        return read_members(xml, type);
    }
    if (kind.starts_with("Enum")) {
        type.kind = DerivedType::Kind::Enumeration;
        ElementaryType base = ElementaryType::Dint;
        return read_base(xml, base) && read_values(xml, "enumerator", type, base);
    }
    type.kind = DerivedType::Kind::Alias;
    if (kind == "ArrayTypeSpec" && !read_dimensions(xml, type.alias)) {
        return false;
    }
    return kind.starts_with("Reference") ? fail(xml, "is a reference, which is not served")
                                         : read_derived(xml, type.alias);
}

bool PlcopenReader::read_derived(const pugi::xml_node& xml, TypeUse& use)
{
    TypeUse base;
    if (!read_use(xml, "baseType", base)) {
        return false;
    }
    base.dimensions.insert(base.dimensions.begin(), use.dimensions.begin(), use.dimensions.end());
    use = std::move(base);
    const pugi::xml_node range =
        child_of(xml, "range") ? child_of(xml, "range") : child_of(xml, "subrange");
    if (!range) {
        return true;
    }
    Bounds bounds;
    if (!read_bounds(range, bounds)) {
        return false;
    }
    use.subrange = bounds;
    return is_integer(use.elementary) ||
           fail(xml, "found a range, expected it of a type of whole numbers");
}

bool PlcopenReader::read_type_name(const pugi::xml_node& xml, TypeUse& use)
{
    // Declarations in a namespace are read as if they stood outside.
    std::string_view text = trimmed_text(xml.text().get());
    const std::size_t step = text.find_last_of(".\\");
    if (step != text.npos && text.find_first_of(" [(") == text.npos) {
        text.remove_prefix(step + 1);
    }
    DeclarationCursor cursor{text,     source_->file, nullptr,
                             *limits_, pass_->memory, pass_->constants};
    TypeUse named;
    const std::size_t most = limits_->max_dimensions;
    if (!read_type_use(cursor, *pass_, named) ||
        !(cursor.is_end() || cursor.fail("the end of the type"))) {
        return fail(xml, "in " + tag_of(xml) + ": " + cursor.problem().text);
    }
    use.dimensions.insert(use.dimensions.end(), named.dimensions.begin(), named.dimensions.end());
    std::swap(named.dimensions, use.dimensions);
    use = std::move(named);
    return use.dimensions.size() <= most
               ? keep(xml, use.type_name.size())
               : fail(xml, "has more than " + std::to_string(most) + " dimensions");
}

} // namespace busbar::controller::detail
