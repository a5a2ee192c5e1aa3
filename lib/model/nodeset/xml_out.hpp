#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace busbar::nodeset {

/// True for a valid name of an element or attribute; letters beyond ASCII are all allowed.
[[nodiscard]] bool is_xml_name(std::string_view text);

/// Writes XML, indented by levels; its input is escaped as needed.
class XmlOut {
public:
    /// Opens an element, whose attributes follow.
    void begin(std::string_view name);
    void attribute(std::string_view name, std::string_view value);
    /// Writes the text of the element; an empty one differs from none.
    void text(std::string_view value);
    /// Writes a complete fragment of XML; one that is not well-formed becomes text.
    void xml(std::string_view fragment);
    /// Closes the last open element.
    void end();

    void element(std::string_view name, std::string_view value)
    {
        begin(name);
        text(value);
        end();
    }

    /// A position of the writer; `back` returns there.
    struct Mark {
        std::size_t size;
        std::size_t level;
        bool is_in_tag;
        bool has_text;
    };
    [[nodiscard]] Mark mark() const { return {text_.size(), open_.size(), is_in_tag_, has_text_}; }
    void back(const Mark& mark);
    [[nodiscard]] std::string take() { return std::move(text_); }

private:
    void close_tag();
    void indent();

    std::string text_;
    std::vector<std::string> open_;
    bool is_in_tag_{false};
    /// The element has text, in which blanks are significant.
    bool has_text_{false};
};

} // namespace busbar::nodeset
