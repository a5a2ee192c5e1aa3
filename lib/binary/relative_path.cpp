#include <busbar/binary/relative_path.hpp>

#include <charconv>

#include <busbar/types/ids.hpp>

namespace busbar::binary {

namespace {

constexpr std::string_view reserved = "/.<>:#!&";

bool is_reserved(char character)
{
    return reserved.find(character) != std::string_view::npos;
}

/// Reads the text from its beginning to its end.
class PathReader {
public:
    PathReader(std::string_view text, FunctionRef<NodeId(const QualifiedName&)> find_type)
        : text_{text}, find_type_{find_type}
    {
    }

    [[nodiscard]] Result<RelativePath> read()
    {
        RelativePath path;
        while (!text_.empty()) {
            // Only the last element may be without a name (Part 4, 7.30).
            if (!path.elements.empty() && path.elements.back().target_name.name.empty()) {
                return fail(status::Bad_SyntaxError);
            }
            const StatusCode bad = read_element(path.elements.emplace_back());
            if (bad.is_bad()) {
                return fail(bad);
            }
        }
        return path.elements.empty() ? Result<RelativePath>{fail(status::Bad_SyntaxError)}
                                     : Result<RelativePath>{std::move(path)};
    }

private:
    [[nodiscard]] bool take(char character)
    {
        if (text_.empty() || text_.front() != character) {
            return false;
        }
        text_.remove_prefix(1);
        return true;
    }
    [[nodiscard]] StatusCode read_element(RelativePathElement& element)
    {
        const StatusCode bad = read_reference(element);
        if (bad.is_bad()) {
            return bad;
        }
        return read_name(element.target_name);
    }
    [[nodiscard]] StatusCode read_reference(RelativePathElement& element)
    {
        element.include_subtypes = true;
        if (take('/')) {
            element.reference_type_id = NodeId{0, id::HierarchicalReferences};
            return status::Good;
        }
        if (take('.')) {
            element.reference_type_id = NodeId{0, id::Aggregates};
            return status::Good;
        }
        if (!take('<')) {
            return status::Bad_SyntaxError;
        }
        element.include_subtypes = !take('#');
        element.is_inverse = take('!');
        QualifiedName name;
        if (read_name(name).is_bad() || name.name.empty() || !take('>')) {
            return status::Bad_SyntaxError;
        }
        element.reference_type_id = find_type_(name);
        return element.reference_type_id.is_null() ? status::Bad_ReferenceTypeIdInvalid
                                                   : status::Good;
    }
    /// Reads up to the beginning of the next part; may be empty.
    [[nodiscard]] StatusCode read_name(QualifiedName& name)
    {
        const bool has_namespace = read_namespace(name.namespace_index);
        std::string plain;
        while (!text_.empty() && (!is_reserved(text_.front()) || text_.front() == '&')) {
            if (take('&') && (text_.empty() || !is_reserved(text_.front()))) {
                return status::Bad_SyntaxError;
            }
            plain.push_back(text_.front());
            text_.remove_prefix(1);
        }
        if (has_namespace && plain.empty()) {
            return status::Bad_SyntaxError;
        }
        name.name = plain.empty() ? String{} : String{plain};
        return status::Good;
    }
    /// Takes "12:"; digits without a colon belong to the name.
    [[nodiscard]] bool read_namespace(std::uint16_t& index)
    {
        const char* const end = text_.data() + text_.size();
        const auto [stop, error] = std::from_chars(text_.data(), end, index);
        if (error != std::errc{} || stop == end || *stop != ':') {
            index = 0;
            return false;
        }
        text_.remove_prefix(static_cast<std::size_t>(stop - text_.data()) + 1);
        return true;
    }

    std::string_view text_;
    FunctionRef<NodeId(const QualifiedName&)> find_type_;
};

void write_name(const QualifiedName& name, std::string& to)
{
    if (name.namespace_index != 0) {
        to += std::to_string(name.namespace_index);
        to += ':';
    }
    for (const char character : name.name.view()) {
        if (is_reserved(character)) {
            to += '&';
        }
        to += character;
    }
}

StatusCode write_reference(const RelativePathElement& element,
                           FunctionRef<QualifiedName(const NodeId&)> name_of, std::string& to)
{
    const bool is_plain = element.include_subtypes && !element.is_inverse;
    if (is_plain && element.reference_type_id.is(id::HierarchicalReferences)) {
        to += '/';
        return status::Good;
    }
    if (is_plain && element.reference_type_id.is(id::Aggregates)) {
        to += '.';
        return status::Good;
    }
    const QualifiedName name = name_of(element.reference_type_id);
    if (name.name.empty()) {
        return status::Bad_ReferenceTypeIdInvalid;
    }
    to += '<';
    to += element.include_subtypes ? "" : "#";
    to += element.is_inverse ? "!" : "";
    write_name(name, to);
    to += '>';
    return status::Good;
}

} // namespace

Result<RelativePath> parse_relative_path(std::string_view text,
                                         FunctionRef<NodeId(const QualifiedName&)> find_type)
{
    return PathReader{text, find_type}.read();
}

Result<std::string> to_text(const RelativePath& path,
                            FunctionRef<QualifiedName(const NodeId&)> name_of)
{
    std::string text;
    for (std::size_t i = 0; i < path.elements.size(); ++i) {
        const RelativePathElement& element = path.elements[i];
        const bool is_last = i + 1 == path.elements.size();
        const QualifiedName& name = element.target_name;
        if (name.name.empty() && (!is_last || name.namespace_index != 0)) {
            return fail(status::Bad_BrowseNameInvalid);
        }
        const StatusCode bad = write_reference(element, name_of, text);
        if (bad.is_bad()) {
            return fail(bad);
        }
        write_name(name, text);
    }
    return text;
}

} // namespace busbar::binary
