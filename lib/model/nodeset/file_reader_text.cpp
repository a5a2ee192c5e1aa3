#include "file_reader.hpp"

#include <algorithm>
#include <utility>

#include "xml_text.hpp"

namespace busbar::nodeset {

NodeId FileReader::node_id(const pugi::xml_node& where, std::string_view text)
{
    if (text.find('=') == std::string_view::npos) {
        return named(where, text);
    }
    auto id = NodeId::parse(text);
    if (!id) {
        fail(where, "found " + quoted(text) + ", expected a NodeId such as \"ns=1;i=42\"");
        return {};
    }
    id->set_namespace_index(namespace_of(where, id->namespace_index()));
    return std::move(*id);
}

NodeId FileReader::named(const pugi::xml_node& where, std::string_view name)
{
    const std::string key{name};
    const auto alias = aliases_.find(key);
    if (alias != aliases_.end()) {
        return alias->second;
    }
    const auto& published = document_.published_names_;
    const auto known = is_lenient_ ? published.find(key) : published.end();
    if (known == published.end()) {
        fail(where, "found " + quoted(name) + ", expected a NodeId or one of the <Aliases>");
        return {};
    }
    document_.add_repair(model::NodeSetRule::Alias,
                         problem_at(name_, line_of(where),
                                    "took " + quoted(name) + ", which has no <Alias>, for " +
                                        to_string(known->second),
                                    current_node_));
    return known->second;
}

NodeId FileReader::node_id_attribute(const pugi::xml_node& xml, const char* attribute,
                                     const NodeId& otherwise)
{
    const pugi::xml_attribute found = xml.attribute(attribute);
    const auto text = trimmed(found.value());
    return text.empty() ? otherwise : node_id(xml, text);
}

std::uint16_t FileReader::namespace_of(const pugi::xml_node& where, std::size_t local)
{
    const auto& map = document_.files_[file_].namespaces;
    if (local >= map.size()) {
        fail(where, "found the namespace index " + std::to_string(local) + ", the file lists " +
                        std::to_string(map.size() - 1) + " in <NamespaceUris>");
        return 0;
    }
    return map[local];
}

void FileReader::bool_attribute(const pugi::xml_node& xml, const char* attribute, bool& value)
{
    const pugi::xml_attribute found = xml.attribute(attribute);
    if (found && !to_bool(trimmed(found.value()), value)) {
        fail(xml, std::string{"found "} + attribute + "=" + quoted(found.value()) +
                      ", expected true or false");
    }
}

void FileReader::dimensions_attribute(const pugi::xml_node& xml, std::vector<std::uint32_t>& value)
{
    const pugi::xml_attribute found = xml.attribute("ArrayDimensions");
    if (found && !to_numbers(found.value(), value)) {
        fail(xml, "found ArrayDimensions=" + quoted(found.value()) +
                      ", expected numbers separated by commas");
    }
}

void FileReader::fail(const pugi::xml_node& where, std::string message)
{
    if (errors_.size() < limits_.max_errors) {
        errors_.push_back(problem_at(name_, line_of(where), std::move(message), current_node_));
    }
}

bool FileReader::count(const pugi::xml_node& where, std::size_t& counter, std::size_t limit,
                       const char* what)
{
    if (counter >= limit) {
        if (counter == limit) {
            fail(where, "there are more than " + std::to_string(limit) + " " + what);
            ++counter;
        }
        return false;
    }
    ++counter;
    return true;
}

std::uint32_t FileReader::line_at(std::ptrdiff_t offset) const
{
    const auto line = std::lower_bound(line_ends_.begin(), line_ends_.end(), offset);
    return static_cast<std::uint32_t>(line - line_ends_.begin()) + 1;
}

std::uint32_t FileReader::line_of(const pugi::xml_node& node) const
{
    return line_at(node.offset_debug());
}

} // namespace busbar::nodeset
