#include <algorithm>

#include "constant_table.hpp"
#include "declaration_keywords.hpp"
#include "declaration_parser.hpp"

namespace busbar::controller::detail {

bool DeclarationParser::read_variables(NetworkPublish publish)
{
    Block block{.publish = publish};
    if (!read_qualifiers(block)) {
        return false;
    }
    while (!cursor_->skip_word("END_VAR")) {
        if (!read_declaration(block)) {
            if (!leave_out(LeftOut::Kind::Variable)) {
                return false;
            }
            if (is_out_of_block("END_VAR")) {
                return true;
            }
        }
    }
    cursor_->skip_symbol(";");
    return true;
}

bool DeclarationParser::read_qualifiers(Block& block)
{
    while (true) {
        if (cursor_->skip_word("CONSTANT")) {
            block.is_constant = true;
        } else if (!block.is_not_retained &&
                   (cursor_->skip_word("RETAIN") || cursor_->skip_word("PERSISTENT"))) {
            block.is_retained = true;
        } else if (!block.is_retained && cursor_->skip_word("NON_RETAIN")) {
            block.is_not_retained = true;
        } else {
            return true;
        }
    }
}

bool DeclarationParser::read_declaration(const Block& block)
{
    std::optional<NetworkPublish> publish;
    declaring_.clear();
    if (!read_pragmas(publish)) {
        return false;
    }
    declaring_publish_ = publish.value_or(block.publish);
    // A second semicolon is common.
    if (cursor_->skip_symbol(";") || cursor_->is_word("END_VAR")) {
        return true;
    }
    GlobalVariable variable;
    if (!read_names(declaring_, "the name of a variable or 'END_VAR'")) {
        return false;
    }
    path_ = declaring_.front().text;
    if (!read_address(variable.address) || !cursor_->expect_symbol(":") ||
        !read_use(variable.type)) {
        return false;
    }
    const std::size_t initial = cursor_->now().offset;
    // A constant whose expression is wrong is known, too, so that its uses can say why.
    const bool is_read = read_initial(variable.initial);
    if ((block.is_constant && !add_constants(variable.type, initial)) || !is_read ||
        !read_pragmas(publish) || !read_end(variable.comment)) {
        return false;
    }
    variable.publish = publish.value_or(block.publish);
    variable.is_constant = block.is_constant;
    variable.is_retained = block.is_retained;
    return add_variables(variable);
}

bool DeclarationParser::add_constants(const TypeUse& type, std::size_t initial)
{
    constexpr std::string_view assign = ":=";
    std::string_view text = cursor_->text_from(initial);
    text.remove_prefix(std::min(text.size(), assign.size()));
    for (const Name& name : declaring_) {
        if (!cursor_->keep(ConstantTable::memory_of_one)) {
            return false;
        }
        cursor_->constants().add_constant({.name = name.text, .text = text, .place = name.place},
                                          type);
    }
    return true;
}

bool DeclarationParser::read_address(std::string& address)
{
    if (!cursor_->is_word("AT")) {
        return true;
    }
    if (declaring_.size() > 1) {
        return cursor_->fail("':', because an address is for one name");
    }
    cursor_->take();
    const DeclarationToken token = cursor_->now();
    if (token.kind != DeclarationToken::Kind::Address || !is_direct_address(token.text) ||
        token.text.size() > cursor_->limits().max_name_length) {
        return cursor_->fail("an address as %IX0.0");
    }
    address = cursor_->take().text;
    return true;
}

bool DeclarationParser::add_variables(const GlobalVariable& variable)
{
    const std::size_t memory = sizeof variable + memory_of(variable.type) +
                               memory_of(variable.initial) + variable.comment.size() +
                               variable.address.size();
    for (Name& name : declaring_) {
        if (!cursor_->keep(memory)) {
            return false;
        }
        GlobalVariable& added = program().variables.emplace_back(variable);
        added.name = std::move(name.text);
        added.place = name.place;
    }
    declaring_.clear();
    return true;
}

} // namespace busbar::controller::detail
