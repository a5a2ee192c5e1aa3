#include <busbar/controller/program_types.hpp>

#include "constant_table.hpp"
#include "declaration_parser.hpp"

namespace busbar::controller::detail {

bool DeclarationParser::read_types()
{
    while (!cursor_->skip_word("END_TYPE")) {
        std::optional<NetworkPublish> unused;
        if (!read_pragmas(unused)) {
            return false;
        }
        if (!cursor_->is_word("END_TYPE") && !read_type()) {
            if (!leave_out(LeftOut::Kind::Type)) {
                return false;
            }
            if (is_out_of_block("END_TYPE")) {
                return true;
            }
        }
    }
    cursor_->skip_symbol(";");
    return true;
}

bool DeclarationParser::read_type()
{
    DerivedType type{.name = {}, .place = cursor_->place()};
    const std::size_t later = cursor_->constants().later_count();
    declaring_.clear();
    declaring_publish_ = {};
    const bool is_quoted = cursor_->is_quoted_name();
    if (!cursor_->keep(sizeof type) ||
        !cursor_->expect_name(type.name, "the name of a type or 'END_TYPE'")) {
        return false;
    }
    declaring_.push_back({type.name, type.place});
    path_ = type.name;
    TypeUse base;
    const std::size_t extends = cursor_->now().offset;
    const ProgramPlace extends_place = cursor_->place();
    BlockHeader unused;
    if (is_quoted && !skip_header(unused)) {
        return false;
    }
    const bool is_colon_omitted = is_quoted && cursor_->is_word("STRUCT");
    if ((cursor_->skip_word("EXTENDS") && !read_qualified(base)) ||
        (!is_colon_omitted && !cursor_->expect_symbol(":")) || !read_type_body(type)) {
        return false;
    }
    if (cursor_->constants().later_count() != later) {
        cursor_->constants().add_unsettled(fold_name(type.name));
    }
    if (!base.type_name.empty()) {
        if (type.kind != DerivedType::Kind::Structure) {
            return cursor_->fail_with(extends, "extends a type, which only a structure can");
        }
        pass_->extensions.push_back(
            {program().types.size(), std::move(base.type_name), extends_place});
    }
    program().types.push_back(std::move(type));
    declaring_.clear();
    skip_semicolons();
    return true;
}

bool DeclarationParser::read_type_body(DerivedType& type)
{
    const bool is_structure = cursor_->is_word("STRUCT");
    if (is_structure || cursor_->is_word("UNION")) {
        cursor_->take();
        type.kind = is_structure ? DerivedType::Kind::Structure : DerivedType::Kind::Union;
        if (!read_members(type, is_structure ? "END_STRUCT" : "END_UNION") ||
            !keep_comment(type.comment) || !read_initial(type.initial)) {
            return false;
        }
        // Vendors omit the semicolon.
        return !cursor_->is_symbol(";") || read_end(type.comment);
    }
    type.kind = DerivedType::Kind::Alias;
    const bool is_read = cursor_->skip_symbol("(") ? read_enumerators(type, {}) && read_base(type)
                                                   : read_use(type.alias, &type);
    if (type.kind != DerivedType::Kind::Alias) {
        type.alias = {};
    }
    return is_read && read_initial(type.initial) && read_end(type.comment);
}

bool DeclarationParser::read_members(DerivedType& type, std::string_view end_word)
{
    ++depth_;
    while (!cursor_->skip_word(end_word)) {
        std::optional<NetworkPublish> unused;
        if (!read_pragmas(unused)) {
            return false;
        }
        if (!cursor_->is_word(end_word) && !read_member(type)) {
            return false;
        }
        skip_semicolons();
    }
    --depth_;
    return true;
}

bool DeclarationParser::read_member(DerivedType& type)
{
    const std::size_t path = path_.size();
    const std::string_view expected = type.kind == DerivedType::Kind::Union
                                          ? "the name of a member or 'END_UNION'"
                                          : "the name of a member or 'END_STRUCT'";
    std::vector<Name> names;
    TypeUse use;
    InitialValue initial;
    std::string comment;
    std::optional<NetworkPublish> unused;
    if (!read_names(names, expected)) {
        return false;
    }
    path_ += "." + names.front().text;
    if (!read_pragmas(unused) || !cursor_->expect_symbol(":") || !read_use(use) ||
        !read_initial(initial) || !read_pragmas(unused) || !read_end(comment)) {
        return false;
    }
    path_.resize(path);
    const std::size_t memory = sizeof(Member) + memory_of(use) + memory_of(initial);
    for (Name& name : names) {
        if (!cursor_->keep(memory)) {
            return false;
        }
        type.members.push_back({std::move(name.text), use, initial, name.place});
    }
    return true;
}

bool DeclarationParser::is_at_nameless() const
{
    return cursor_->is_word("STRUCT") || cursor_->is_word("UNION") || cursor_->is_symbol("(");
}

bool DeclarationParser::read_nameless(TypeUse& use)
{
    DerivedType type{.name = path_, .place = cursor_->place()};
    const std::size_t later = cursor_->constants().later_count();
    const std::size_t most = cursor_->limits().max_depth;
    if (depth_ > most) {
        return cursor_->fail_with(cursor_->now().offset,
                                  "is within more than " + std::to_string(most) + " structures");
    }
    if (cursor_->skip_symbol("(")) {
        type.name += ".ENUM";
        if (!read_enumerators(type, {}) || !read_base(type)) {
            return false;
        }
    } else {
        const bool is_union = cursor_->skip_word("UNION");
        type.kind = is_union ? DerivedType::Kind::Union : DerivedType::Kind::Structure;
        type.name += is_union ? ".UNION" : ".STRUCT";
        if ((!is_union && !cursor_->expect_word("STRUCT")) ||
            !read_members(type, is_union ? "END_UNION" : "END_STRUCT")) {
            return false;
        }
    }
    use.type_name = type.name;
    if (cursor_->constants().later_count() != later) {
        cursor_->constants().add_unsettled(fold_name(type.name));
    }
    if (!cursor_->keep(sizeof type + 2 * type.name.size())) {
        return false;
    }
    program().types.push_back(std::move(type));
    return true;
}

} // namespace busbar::controller::detail
