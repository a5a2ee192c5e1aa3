#include <cstring>
#include <map>
#include <set>

#include <pugixml.hpp>

#include <busbar/controller/node_roles.hpp>
#include <busbar/controller/project_compare.hpp>
#include <busbar/core/text.hpp>
#include <busbar/core/text_forms.hpp>

namespace busbar::controller {

namespace {

constexpr unsigned how_to_read = pugi::parse_default & ~pugi::parse_doctype;

/// A node of a file as two texts, equal for equal nodes of two files.
struct NodeTexts {
    std::string node;
    std::string mapping; // <Extensions>
    /// Labels by the part's name in a mapping table, "", "[0].Speed" or "Handle", and "Roles".
    std::map<std::string, std::string> labels{};
};

struct ModelTexts {
    std::string uri;
    std::map<std::string, NodeTexts> nodes{};
    /// The rest of the file: its namespaces, models and aliases.
    NodeTexts rest{};
};

struct StringWriter final : pugi::xml_writer {
    explicit StringWriter(std::string& text) : to{text} {}
    void write(const void* data, std::size_t size) override
    {
        to.append(static_cast<const char*>(data), size);
    }

    std::string& to;
};

void append_xml(std::string& to, const pugi::xml_node& node)
{
    StringWriter writer{to};
    node.print(writer, "", pugi::format_raw);
}

/// Collects the labels of a mapping's elements (SH-082679, Appendix 8) by the names of their parts.
void collect_labels(const pugi::xml_node& element, const std::string& path, std::size_t level,
                    std::map<std::string, std::string>& labels)
{
    constexpr std::size_t max_levels = 64;
    if (const pugi::xml_attribute label = element.attribute("Data")) {
        labels[path] = label.value();
    }
    for (const char* const addition : {"Quality", "Scaling", "Done"}) {
        if (const pugi::xml_attribute label = element.attribute(addition)) {
            labels[addition] = label.value();
        }
    }
    for (const pugi::xml_node& each : element.children()) {
        const std::string_view name = each.name();
        const std::string number = "[" + std::string{each.attribute("Num").value()} + "]";
        const std::string step =
            name == "Element"    ? number
            : name == "Field"    ? "." + std::string{each.attribute("Name").value()}
            : name == "Argument" ? number
            : name == "Handle" || name == "Input" || name == "Output" ? std::string{name}
                                                                      : "";
        if (level < max_levels) {
            collect_labels(each, path + step, level + 1, labels);
        }
    }
}

/// Returns the text of a node's <RolePermissions>.
std::string roles_of(const pugi::xml_node& element)
{
    Array<RolePermissionType> roles;
    for (const pugi::xml_node& each : element.children()) {
        const auto id = parse_expanded_node_id(each.text().get());
        roles.push_back(
            {id ? id->node_id : NodeId{}, PermissionType{each.attribute("Permissions").as_uint()}});
    }
    return roles_text(roles.span());
}

NodeTexts texts_of(pugi::xml_node node)
{
    NodeTexts texts;
    for (pugi::xml_node each = node.first_child(); each;) {
        const pugi::xml_node next = each.next_sibling();
        if (std::strcmp(each.name(), "Extensions") == 0) {
            append_xml(texts.mapping, each);
            collect_labels(each, {}, 0, texts.labels);
            node.remove_child(each);
        } else if (std::strcmp(each.name(), "RolePermissions") == 0) {
            texts.labels["Roles"] = roles_of(each);
            node.remove_child(each);
        }
        each = next;
    }
    append_xml(texts.node, node);
    return texts;
}

/// Splits the file into texts. A file that is not XML becomes one text: check() accepts any.
ModelTexts read_texts(const ProjectModel& model)
{
    ModelTexts texts{model.name};
    pugi::xml_document document;
    if (!document.load_buffer(model.text.data(), model.text.size(), how_to_read)) {
        texts.rest.node = model.text;
        return texts;
    }
    const pugi::xml_node set = document.child("UANodeSet");
    const std::string uri = set.child("Models").child("Model").attribute("ModelUri").value();
    texts.uri = uri.empty() ? texts.uri : uri;
    for (const pugi::xml_node& each : set.children()) {
        const std::string id = each.attribute("NodeId").value();
        if (id.empty()) {
            append_xml(texts.rest.node, each);
        } else {
            texts.nodes[id] = texts_of(each);
        }
    }
    return texts;
}

using Models = std::map<std::string, ModelTexts>;

Models read_all(const Project& project)
{
    Models all;
    for (const ProjectModel& model : project.models) {
        ModelTexts texts = read_texts(model);
        all[texts.uri] = std::move(texts);
    }
    return all;
}

std::string label_at(const std::map<std::string, std::string>& labels, const std::string& part)
{
    const auto found = labels.find(part);
    return found != labels.end() ? printable(found->second, 800)
           : part == "Roles"     ? "everybody"
                                 : "no label";
}

class ModelComparison {
public:
    void add(std::string where, std::string_view first, std::string_view second)
    {
        if (found_.size() < max_project_differences) {
            found_.push_back({printable(where), std::string{first}, std::string{second}});
        }
    }
    void compare(const std::string& where, const NodeTexts& a, const NodeTexts& b)
    {
        if (a.node != b.node) {
            add(where, "another node", "another node");
        }
        if (a.labels != b.labels) {
            compare_labels(where, a.labels, b.labels);
        } else if (a.mapping != b.mapping) {
            add(where, "another array specification", "another array specification");
        }
    }
    void compare_labels(const std::string& where, const std::map<std::string, std::string>& first,
                        const std::map<std::string, std::string>& second)
    {
        std::map<std::string, std::string> all = first;
        all.insert(second.begin(), second.end());
        for (const auto& [part, label] : all) {
            const std::string a = label_at(first, part);
            const std::string b = label_at(second, part);
            if (a != b) {
                add(part.empty() ? where : where + ": " + part, a, b);
            }
        }
    }
    void compare(const ModelTexts& a, const ModelTexts& b);
    [[nodiscard]] std::vector<ProjectDifference> take() { return std::move(found_); }

private:
    std::vector<ProjectDifference> found_;
};

void ModelComparison::compare(const ModelTexts& a, const ModelTexts& b)
{
    if (a.rest.node != b.rest.node) {
        add(a.uri, "other models, namespaces or aliases", "other models, namespaces or aliases");
    }
    for (const auto& [id, texts] : a.nodes) {
        const auto other = b.nodes.find(id);
        if (other == b.nodes.end()) {
            add(a.uri + ": " + id, "a node", "nothing");
        } else {
            compare(a.uri + ": " + id, texts, other->second);
        }
    }
    for (const auto& [id, texts] : b.nodes) {
        if (!a.nodes.contains(id)) {
            add(a.uri + ": " + id, "nothing", "a node");
        }
    }
}

} // namespace

std::vector<ProjectDifference> model_differences(const Project& first, const Project& second)
{
    const Models ours = read_all(first);
    const Models theirs = read_all(second);
    ModelComparison comparison;
    for (const auto& [uri, model] : ours) {
        const auto other = theirs.find(uri);
        if (other == theirs.end()) {
            comparison.add(uri, "a model", "nothing");
        } else {
            comparison.compare(model, other->second);
        }
    }
    for (const auto& [uri, model] : theirs) {
        if (!ours.contains(uri)) {
            comparison.add(uri, "nothing", "a model");
        }
    }
    return comparison.take();
}

} // namespace busbar::controller
