#include "table_fields.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::size_t max_fields = 64;

} // namespace

void add_field(std::string& to, std::string_view field)
{
    // Blanks at the ends belong to the field, but some programs drop them without quotation marks.
    const bool has_blanks = !field.empty() && (field.front() == ' ' || field.back() == ' ');
    if (!has_blanks && field.find_first_of(",\"\r\n") == std::string_view::npos) {
        to += field;
        return;
    }
    to += '"';
    for (const char c : field) {
        to += c;
        if (c == '"') {
            to += c;
        }
    }
    to += '"';
}

TableFields::TableFields(std::string_view text, std::size_t max_field)
    : text_{text}, max_field_{max_field}
{
    const std::string_view header = text_.substr(0, text_.find_first_of("\r\n"));
    const std::size_t first = header.find_first_of(",;\t");
    if (first != std::string_view::npos) {
        separator_ = header[first];
    }
}

TableFields::Line TableFields::next(std::vector<std::string>& fields)
{
    fields.clear();
    line_ = next_line_;
    if (is_at_end()) {
        return Line::End;
    }
    while (true) {
        if (fields.size() == max_fields) {
            return Line::TooLarge;
        }
        const Line read = read_field(fields.emplace_back());
        if (read != Line::Read) {
            return read;
        }
        if (is_at_break()) {
            pass_break();
            return Line::Read;
        }
        ++at_; // the separator
    }
}

TableFields::Line TableFields::read_field(std::string& field)
{
    if (!is_at_end() && text_[at_] == '"') {
        return read_quoted(field);
    }
    const std::size_t begin = at_;
    while (!is_at_break() && text_[at_] != separator_) {
        if (text_[at_] == '"') {
            return Line::Broken;
        }
        ++at_;
    }
    if (at_ - begin > max_field_) {
        return Line::TooLarge;
    }
    field = text_.substr(begin, at_ - begin);
    return Line::Read;
}

TableFields::Line TableFields::read_quoted(std::string& field)
{
    ++at_;
    while (!is_at_end()) {
        const char c = text_[at_++];
        if (c == '"') {
            if (is_at_end() || text_[at_] != '"') {
                return is_at_break() || text_[at_] == separator_ ? Line::Read : Line::Broken;
            }
            ++at_;
        }
        next_line_ += c == '\n' ? 1U : 0U;
        if (field.size() == max_field_) {
            return Line::TooLarge;
        }
        field += c;
    }
    return Line::Broken;
}

void TableFields::pass_break()
{
    if (!is_at_end() && text_[at_] == '\r') {
        ++at_;
    }
    if (!is_at_end() && text_[at_] == '\n') {
        ++at_;
    }
    ++next_line_;
}

} // namespace busbar::controller::detail
