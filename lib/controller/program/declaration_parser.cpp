#include "declaration_parser.hpp"

#include "declaration_cursor.hpp"
#include "declaration_keywords.hpp"

namespace busbar::controller::detail {

bool DeclarationParser::read()
{
    while (!cursor_->is_end()) {
        if (!read_block()) {
            if (!leave_out(LeftOut::Kind::Part)) {
                return false;
            }
            skip_to_block();
        }
    }
    return true;
}

bool DeclarationParser::read_block()
{
    std::optional<NetworkPublish> publish;
    if (!read_pragmas(publish)) {
        return false;
    }
    if (cursor_->skip_word("TYPE")) {
        return read_types();
    }
    if (cursor_->skip_word("VAR_GLOBAL")) {
        return read_variables(publish.value_or(NetworkPublish::Hidden));
    }
    if (cursor_->skip_word("CONFIGURATION")) {
        return read_configuration();
    }
    if (cursor_->skip_word("RESOURCE")) {
        return read_resource();
    }
    if (cursor_->skip_word("DATA_BLOCK")) {
        return read_data_block() || (leave_out(LeftOut::Kind::Variable) && skip_data_block());
    }
    bool is_part = false;
    const bool is_read = read_beside(is_part);
    return is_part ? is_read
                   : cursor_->is_end() || cursor_->skip_symbol(";") ||
                         cursor_->fail("TYPE, VAR_GLOBAL, CONFIGURATION or RESOURCE");
}

bool DeclarationParser::read_pragmas(std::optional<NetworkPublish>& publish)
{
    while (cursor_->now().kind == DeclarationToken::Kind::Pragma) {
        const DeclarationToken token = cursor_->take();
        const PublishPragma pragma = read_publish_pragma(token.text);
        if (pragma.is_publish && !pragma.publish) {
            return cursor_->fail_with(
                token.offset,
                "found a publish attribute that is not known, expected 'none', 'publish only', "
                "'input' or 'output'");
        }
        publish = pragma.is_publish ? pragma.publish : publish;
    }
    return true;
}

bool DeclarationParser::read_names(std::vector<Name>& names, std::string_view what)
{
    do {
        Name name{.text = {}, .place = cursor_->place()};
        if (!cursor_->expect_name(name.text, what) || !cursor_->keep(sizeof name)) {
            return false;
        }
        names.push_back(std::move(name));
    } while (cursor_->skip_symbol(","));
    return true;
}

bool DeclarationParser::read_initial(InitialValue& initial)
{
    return !cursor_->skip_symbol(":=") || read_initial_value(*cursor_, initial);
}

bool DeclarationParser::read_end(std::string& comment)
{
    // Vendors omit it after the last member of a structure.
    const bool is_omitted =
        leaves_out_ && (cursor_->is_word("END_STRUCT") || cursor_->is_word("END_UNION"));
    return (is_omitted || cursor_->expect_symbol(";")) && keep_comment(comment);
}

bool DeclarationParser::keep_comment(std::string& comment)
{
    comment = cursor_->comment();
    return cursor_->keep(comment.size());
}

} // namespace busbar::controller::detail
