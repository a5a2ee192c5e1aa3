#include <algorithm>

#include <busbar/controller/program_types.hpp>

#include "controller/program/declaration_keywords.hpp"
#include "controller/program/program_problem.hpp"
#include "plcopen_reader.hpp"

namespace busbar::controller::detail {

namespace {

/// The <data> in which CODESYS names the structure that a type extends.
constexpr std::string_view extends_data =
    "http://www.3s-software.com/plcopenxml/datatypeinheritance";

/// Returns the end of the name that a type without one gets; empty for an element that is not such
/// a type.
std::string_view nameless_suffix(const pugi::xml_node& xml)
{
    const bool is_specification = is_named(xml, "instantlyDefinedType");
    const std::string_view name = is_specification ? specification_of(xml) : local_name_of(xml);
    if (name == "struct" || (is_specification && name.starts_with("Struct"))) {
        return ".STRUCT";
    }
    if (name == "union" || (is_specification && name.starts_with("Union"))) {
        return ".UNION";
    }
    return name == "enum" || (is_specification && name.starts_with("Enum")) ? ".ENUM" : "";
}

} // namespace

bool PlcopenReader::read_type(const pugi::xml_node& xml)
{
    DerivedType type{.name = {}, .place = place_of(xml)};
    const std::size_t later = pass_->constants.later_count();
    // Some vendors write a union as a type of its own.
    const bool is_union = is_named(xml, "union");
    const pugi::xml_node body = is_union ? xml : first_element_of(child_of(xml, "baseType"));
    if (!keep(xml, sizeof type) || !read_name(xml, "name", type.name)) {
        return false;
    }
    if (!body) {
        return fail(xml, "found <dataType>, expected a type in its <baseType>");
    }
    path_ = type.name;
    if (!read_type_body(body, type) || !read_initial(xml, type.initial) ||
        !read_documentation(xml, type.comment) || !read_extends(xml, type)) {
        return false;
    }
    if (pass_->constants.later_count() != later) {
        pass_->constants.add_unsettled(fold_name(type.name));
    }
    pass_->program.types.push_back(std::move(type));
    return true;
}

bool PlcopenReader::read_type_body(const pugi::xml_node& xml, DerivedType& type)
{
    const std::string_view name = local_name_of(xml);
    if (name == "struct" || name == "union") {
        type.kind = name == "struct" ? DerivedType::Kind::Structure : DerivedType::Kind::Union;
        return read_members(xml, type);
    }
    if (name == "enum") {
        type.kind = DerivedType::Kind::Enumeration;
        return read_enumerators(xml, type);
    }
    type.kind = DerivedType::Kind::Alias;
    return read_one_use(xml, type.alias);
}

bool PlcopenReader::read_members(const pugi::xml_node& xml, DerivedType& type)
{
    const std::string_view element = child_of(xml, "member") ? "member" : "variable";
    for (const pugi::xml_node& child : xml.children()) {
        if (!is_named(child, element)) {
            continue;
        }
        Member member{.name = {}, .place = place_of(child)};
        if (!keep(child, sizeof member) || !read_name(child, "name", member.name)) {
            return false;
        }
        const std::size_t path = path_.size();
        path_ += "." + member.name;
        const bool is_read = read_use(child, "type", member.type);
        path_.resize(path);
        if (!is_read || !read_initial(child, member.initial)) {
            return false;
        }
        type.members.push_back(std::move(member));
    }
    return true;
}

bool PlcopenReader::read_base(const pugi::xml_node& xml, ElementaryType& base)
{
    if (const pugi::xml_node holder = child_of(xml, "baseType")) {
        TypeUse use;
        if (!read_use(xml, "baseType", use)) {
            return false;
        }
        if (!use.type_name.empty() || !use.dimensions.empty() || !is_integer(use.elementary)) {
            return fail(holder, "found another type, expected one of whole numbers");
        }
        base = use.elementary;
    }
    return true;
}

bool PlcopenReader::read_enumerators(const pugi::xml_node& xml, DerivedType& type)
{
    ElementaryType base = ElementaryType::Dint;
    return read_base(xml, base) && read_values(child_of(xml, "values"), "value", type, base);
}

bool PlcopenReader::read_values(const pugi::xml_node& xml, std::string_view element,
                                DerivedType& type, ElementaryType base)
{
    pass_->constants.begin_enumeration(type.name);
    bool is_read = true;
    for (const pugi::xml_node& child : xml.children()) {
        is_read = is_read && (!is_named(child, element) || read_enumerator(child, type, base));
    }
    pass_->constants.end_enumeration();
    return is_read;
}

bool PlcopenReader::read_enumerator(const pugi::xml_node& xml, DerivedType& type,
                                    ElementaryType base)
{
    Enumerator one;
    std::int64_t value =
        type.enumerators.empty() ? 0 : std::int64_t{type.enumerators.back().value} + 1;
    if (!keep(xml, sizeof one + ConstantTable::memory_of_one) ||
        !read_name(xml, "name", one.name) ||
        (xml.attribute("value") && !read_number(xml, "value", value))) {
        return false;
    }
    pass_->constants.add_enumerator({.name = one.name,
                                     .text = trimmed_text(xml.attribute("value").value()),
                                     .place = place_of(xml)});
    if (!number_fits(base, Variant{value}) || value < INT32_MIN || value > INT32_MAX) {
        return fail(xml, "found the value " + std::to_string(value) +
                             ", expected one of 32 bits with a sign and of the base type");
    }
    one.value = static_cast<std::int32_t>(value);
    type.enumerators.push_back(std::move(one));
    return true;
}

bool PlcopenReader::read_use(const pugi::xml_node& xml, std::string_view holder, TypeUse& use)
{
    const pugi::xml_node type = first_element_of(child_of(xml, holder));
    return type ? read_one_use(type, use)
                : fail(xml, "found " + tag_of(xml) + ", expected a type in its <" +
                                std::string{holder} + ">");
}

bool PlcopenReader::read_one_use(const pugi::xml_node& xml, TypeUse& use)
{
    pugi::xml_node type = xml;
    while (local_name_of(type) == "array" || is_array_specification(type)) {
        const pugi::xml_node element = first_element_of(child_of(type, "baseType"));
        if (!read_dimensions(type, use)) {
            return false;
        }
        if (!element) {
            return fail(type, "found " + tag_of(type) + ", expected a type in its <baseType>");
        }
        type = element;
    }
    const std::string_view name = local_name_of(type);
    if (name == "TypeName") {
        return read_type_name(type, use);
    }
    if (name == "derived") {
        return read_derived_name(type, use);
    }
    if (!nameless_suffix(type).empty()) {
        return read_nameless(type, use);
    }
    if (name == "subrangeSigned" || name == "subrangeUnsigned") {
        return read_subrange(type, use);
    }
    const auto elementary = elementary_type(name);
    if (!elementary) {
        return fail(type, "found " + tag_of(type) + ", expected a type that is known here");
    }
    use.elementary = *elementary;
    const bool has_length =
        use.elementary == ElementaryType::String || use.elementary == ElementaryType::Wstring;
    if (!has_length || !type.attribute("length")) {
        return true;
    }
    std::int64_t length = 0;
    if (!read_number(type, "length", length)) {
        return false;
    }
    use.string_length = static_cast<std::uint32_t>(length);
    return (length > 0 && length < UINT32_MAX) ||
           fail(type, "found the length " + std::to_string(length) + ", expected one from 1 on");
}

bool PlcopenReader::read_nameless(const pugi::xml_node& xml, TypeUse& use)
{
    const std::size_t later = pass_->constants.later_count();
    if (depth_ > limits_->max_depth) {
        return fail(xml,
                    "is within more than " + std::to_string(limits_->max_depth) + " structures");
    }
    DerivedType type{.name = path_ + std::string{nameless_suffix(xml)}, .place = place_of(xml)};
    if (!keep(xml, sizeof type + 2 * type.name.size())) {
        return false;
    }
    ++depth_;
    const bool is_read = is_named(xml, "instantlyDefinedType") ? read_specification(xml, type)
                                                               : read_type_body(xml, type);
    --depth_;
    if (!is_read) {
        return false;
    }
    if (pass_->constants.later_count() != later) {
        pass_->constants.add_unsettled(fold_name(type.name));
    }
    use.type_name = type.name;
    pass_->program.types.push_back(std::move(type));
    return true;
}

bool PlcopenReader::read_extends(const pugi::xml_node& xml, const DerivedType& type)
{
    for (const pugi::xml_node& data : child_of(xml, "addData").children()) {
        if (std::string_view{data.attribute("name").value()} != extends_data) {
            continue;
        }
        const std::string_view base =
            trimmed_text(child_of(child_of(data, "Inheritance"), "Extends").text().get());
        if (base.empty() || type.kind != DerivedType::Kind::Structure) {
            return fail(data, "found <Inheritance>, expected <Extends> of a structure with the "
                              "name of another");
        }
        if (!keep(data, sizeof(Extension) + base.size())) {
            return false;
        }
        pass_->extensions.push_back({pass_->program.types.size(), std::string{base},
                                     source_->places.at(static_cast<std::size_t>(
                                         std::max(data.offset_debug(), std::ptrdiff_t{0})))});
    }
    return true;
}

bool PlcopenReader::read_derived_name(const pugi::xml_node& xml, TypeUse& use)
{
    if (!read_name(xml, "name", use.type_name)) {
        return false;
    }
    // Types that the schema lacks, such as LTIME, are written by their names.
    if (const auto elementary = elementary_type(use.type_name)) {
        use.elementary = *elementary;
        use.type_name.clear();
    }
    return true;
}

bool PlcopenReader::read_dimensions(const pugi::xml_node& xml, TypeUse& use)
{
    const std::size_t before = use.dimensions.size();
    for (const pugi::xml_node& child : xml.children()) {
        if (!is_named(child, "dimension") && !is_named(child, "dimensionSpec")) {
            continue;
        }
        if (use.dimensions.size() == limits_->max_dimensions) {
            return fail(child,
                        "has more than " + std::to_string(limits_->max_dimensions) + " dimensions");
        }
        Bounds bounds;
        const pugi::xml_node range = child_of(child, "indexRange");
        if (!keep(child, sizeof bounds) || !read_bounds(range ? range : child, bounds)) {
            return false;
        }
        use.dimensions.push_back(bounds);
    }
    return use.dimensions.size() > before || fail(xml, "found <array>, expected <dimension>");
}

bool PlcopenReader::read_subrange(const pugi::xml_node& xml, TypeUse& use)
{
    const pugi::xml_node range = child_of(xml, "range");
    const pugi::xml_node base = first_element_of(child_of(xml, "baseType"));
    const auto elementary = elementary_type(local_name_of(base));
    if (!range || !elementary || !is_integer(*elementary)) {
        return fail(xml, "found " + tag_of(xml) +
                             ", expected <range> and a type of whole numbers in its <baseType>");
    }
    Bounds bounds;
    if (!read_bounds(range, bounds)) {
        return false;
    }
    use.elementary = *elementary;
    use.subrange = bounds;
    return true;
}

bool PlcopenReader::read_bounds(const pugi::xml_node& xml, Bounds& bounds)
{
    return read_number(xml, "lower", bounds.lower) && read_number(xml, "upper", bounds.upper) &&
           (bounds.lower <= bounds.upper ||
            fail(xml, "found the bounds " + std::to_string(bounds.lower) + ".." +
                          std::to_string(bounds.upper) + ", expected the lower one first"));
}

} // namespace busbar::controller::detail
