#include "xml_out.hpp"

#include <algorithm>

#include <pugixml.hpp>

namespace busbar::nodeset {

namespace {

/// Line ends other than
/// would be lost, and in attributes all of them.
void append_escaped(std::string& to, std::string_view text, bool is_attribute)
{
    for (const char c : text) {
        switch (c) {
        case '&':
            to += "&amp;";
            break;
        case '<':
            to += "&lt;";
            break;
        case '>':
            to += "&gt;";
            break;
        case '"':
            to += "&quot;";
            break;
        case '\0':
            // XML cannot contain it.
            to += "&#xFFFD;";
            break;
        default:
            if (c == '\r' || (static_cast<unsigned char>(c) < ' ' && (is_attribute || c != '\n'))) {
                to += "&#" + std::to_string(static_cast<int>(c)) + ';';
            } else {
                to += c;
            }
        }
    }
}

class StringWriter : public pugi::xml_writer {
public:
    explicit StringWriter(std::string& to) : to_{to} {}
    void write(const void* data, std::size_t size) override
    {
        to_.append(static_cast<const char*>(data), size);
    }

private:
    std::string& to_;
};

bool is_name_start(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
           static_cast<unsigned char>(c) >= 0x80U;
}

} // namespace

bool is_xml_name(std::string_view text)
{
    return !text.empty() && is_name_start(text.front()) &&
           std::all_of(text.begin(), text.end(), [](char c) {
               return is_name_start(c) || (c >= '0' && c <= '9') || c == '-' || c == '.';
           });
}

void XmlOut::close_tag()
{
    if (is_in_tag_) {
        text_ += '>';
        is_in_tag_ = false;
    }
}

void XmlOut::indent()
{
    if (!has_text_ && !text_.empty()) {
        text_ += '\n';
        text_.append(open_.size() * 2, ' ');
    }
}

void XmlOut::begin(std::string_view name)
{
    close_tag();
    indent();
    text_ += '<';
    text_ += name;
    open_.emplace_back(name);
    is_in_tag_ = true;
    has_text_ = false;
}

void XmlOut::attribute(std::string_view name, std::string_view value)
{
    text_ += ' ';
    text_ += name;
    text_ += "=\"";
    append_escaped(text_, value, true);
    text_ += '"';
}

void XmlOut::text(std::string_view value)
{
    close_tag();
    has_text_ = true;
    if (value.empty()) {
        text_ += "<![CDATA[]]>";
    }
    append_escaped(text_, value, false);
}

void XmlOut::xml(std::string_view fragment)
{
    pugi::xml_document document;
    const auto parsed = document.load_buffer(fragment.data(), fragment.size(),
                                             pugi::parse_default | pugi::parse_fragment |
                                                 pugi::parse_ws_pcdata_single,
                                             pugi::encoding_utf8);
    if (!parsed) {
        text(fragment);
        return;
    }
    close_tag();
    has_text_ = true;
    StringWriter writer{text_};
    document.save(writer, "", pugi::format_raw | pugi::format_no_declaration, pugi::encoding_utf8);
}

void XmlOut::end()
{
    const std::string name = std::move(open_.back());
    open_.pop_back();
    if (is_in_tag_) {
        text_ += "/>";
        is_in_tag_ = false;
    } else {
        indent();
        text_ += "</" + name + '>';
    }
    has_text_ = false;
}

void XmlOut::back(const Mark& mark)
{
    text_.resize(mark.size);
    open_.resize(mark.level);
    is_in_tag_ = mark.is_in_tag;
    has_text_ = mark.has_text;
}

} // namespace busbar::nodeset
