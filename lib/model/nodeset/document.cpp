#include "document.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <busbar/core/text.hpp>

#include "file_reader.hpp"

namespace busbar::nodeset {

namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { static_cast<void>(std::fclose(file)); }
};

/// Returns the bytes of a file, or the reason why it cannot be read.
Expected<std::string, std::string> read_bytes(const std::string& path, std::size_t limit)
{
    const std::unique_ptr<std::FILE, CloseFile> file{std::fopen(path.c_str(), "rb")};
    if (file == nullptr) {
        return Unexpected{"cannot be opened: " + std::string{std::strerror(errno)}};
    }
    std::string text;
    std::string block(std::size_t{1} << 16U, '\0');
    while (const std::size_t count = std::fread(block.data(), 1, block.size(), file.get())) {
        if (text.size() + count > limit) {
            return Unexpected{"is larger than " + std::to_string(limit) + " bytes"};
        }
        text.append(block, 0, count);
    }
    if (std::ferror(file.get()) != 0) {
        return Unexpected{"cannot be read: " + std::string{std::strerror(errno)}};
    }
    return text;
}

} // namespace

std::string_view name(NodeClass node_class)
{
    switch (node_class) {
    case NodeClass::Object:
        return "Object";
    case NodeClass::Variable:
        return "Variable";
    case NodeClass::Method:
        return "Method";
    case NodeClass::ObjectType:
        return "ObjectType";
    case NodeClass::VariableType:
        return "VariableType";
    case NodeClass::ReferenceType:
        return "ReferenceType";
    case NodeClass::DataType:
        return "DataType";
    case NodeClass::View:
        return "View";
    }
    return "Unspecified";
}

Problem problem_at(const std::string& file, std::uint32_t line, std::string text,
                   std::string_view node)
{
    Problem problem;
    problem.where = file;
    if (line != 0) {
        problem.where += ':' + std::to_string(line);
    }
    if (!node.empty()) {
        problem.where += ": " + printable(node, 80);
    }
    problem.text = std::move(text);
    return problem;
}

const Element* Element::child(std::string_view local_name) const
{
    const auto found = std::find_if(children.begin(), children.end(),
                                    [&](const Element& e) { return e.name == local_name; });
    return found == children.end() ? nullptr : &*found;
}

std::vector<Problem> Document::load_file(const std::string& path, bool is_lenient)
{
    const auto text = read_bytes(path, limits_.max_file_size);
    if (!text) {
        return {problem_at(path, 0, text.error())};
    }
    return load_text(*text, path, is_lenient);
}

std::vector<Problem> Document::load_text(std::string_view text, const std::string& name,
                                         bool is_lenient)
{
    if (text.size() > limits_.max_file_size) {
        return {problem_at(name, 0,
                           "is larger than " + std::to_string(limits_.max_file_size) + " bytes")};
    }
    FileReader reader{*this, name, is_lenient};
    return reader.read(text);
}

void Document::add_repair(model::NodeSetRule rule, Problem done)
{
    ++repair_counts_[static_cast<std::size_t>(rule)];
    if (repairs_.size() < limits_.max_errors) {
        repairs_.push_back({rule, std::move(done)});
    }
}

std::optional<std::uint16_t> Document::namespace_index(std::string_view uri) const
{
    const auto found = std::find(namespaces_.begin(), namespaces_.end(), uri);
    if (found == namespaces_.end()) {
        return std::nullopt;
    }
    return static_cast<std::uint16_t>(found - namespaces_.begin());
}

const Node* Document::find(const NodeId& id) const
{
    const auto found = by_id_.find(id);
    return found == by_id_.end() ? nullptr : &nodes_[found->second];
}

Problem Document::problem(const Node& node, std::string text, std::uint32_t line) const
{
    const File& file = files_[node.file];
    NodeId local = node.id;
    const auto& map = file.namespaces;
    const auto found = std::find(map.begin(), map.end(), local.namespace_index());
    local.set_namespace_index(static_cast<std::uint16_t>(found - map.begin()));
    return problem_at(file.name, line == 0 ? node.line : line, std::move(text), to_string(local));
}

} // namespace busbar::nodeset
