#include "model_state.hpp"

#include <fstream>
#include <optional>
#include <set>

#include <busbar/core/text.hpp>

#include "core/number_text.hpp"
#include "extension_xml.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::string_view standard_namespace = "http://opcfoundation.org/UA/";
constexpr std::size_t max_models = 1'000;

pugi::xml_node child_of(const pugi::xml_node& xml, std::string_view name)
{
    for (const pugi::xml_node& child : xml.children()) {
        if (local_name(child) == name) {
            return child;
        }
    }
    return {};
}

HeaderModel model_of(const pugi::xml_node& xml)
{
    return {xml.attribute("ModelUri").value(), xml.attribute("Version").value(),
            xml.attribute("PublicationDate").value(), xml.attribute("ModelVersion").value()};
}

/// Parses the namespace index of a NodeId such as "ns=3;i=1"; nothing for other texts.
std::optional<std::uint16_t> namespace_of(std::string_view id)
{
    const auto parsed = NodeId::parse(id);
    return parsed ? std::optional{parsed->namespace_index()} : std::nullopt;
}

/// URIs by their indices in the file.
std::vector<std::string> namespaces_of(const pugi::xml_node& root)
{
    std::vector<std::string> uris{std::string{standard_namespace}};
    for (const pugi::xml_node& uri : child_of(root, "NamespaceUris").children()) {
        if (uri.type() == pugi::node_element) {
            uris.emplace_back(uri.text().get());
        }
    }
    return uris;
}

/// Collects the URIs of all namespaces that nodes of the file are in.
std::set<std::string> node_namespaces(const pugi::xml_node& root,
                                      const std::vector<std::string>& uris)
{
    std::set<std::string> found;
    for (const pugi::xml_node& child : root.children()) {
        const pugi::xml_attribute id = child.attribute("NodeId");
        const auto index = id ? namespace_of(id.value()) : std::nullopt;
        if (index && *index < uris.size()) {
            found.insert(uris[*index]);
        }
    }
    return found;
}

/// Lists the file's models except that of namespace 0.
std::vector<pugi::xml_node> models_in(const pugi::xml_node& root)
{
    std::vector<pugi::xml_node> models;
    for (const pugi::xml_node& model : child_of(root, "Models").children()) {
        if (local_name(model) == "Model" && models.size() < max_models) {
            models.push_back(model);
        }
    }
    return models;
}

} // namespace

Expected<ModelHeader, ModelReport> read_header(std::string_view text, const std::string& name)
{
    const auto refuse = [&](ModelCode code, std::string_view found) {
        return Unexpected{ModelReport{code, {}, printable(name), printable(found)}};
    };
    pugi::xml_document document;
    const auto parsed = document.load_buffer(text.data(), text.size());
    if (!parsed) {
        return refuse(ModelCode::FileInvalid, parsed.description());
    }
    const pugi::xml_node root = document.document_element();
    std::vector<std::string> named = namespaces_of(root);
    std::set<std::string> uris = node_namespaces(root, named);
    const auto models = models_in(root);
    for (const pugi::xml_node& model : models) {
        uris.insert(model.attribute("ModelUri").value());
    }
    if (uris.size() > 1) {
        return refuse(ModelCode::SeveralNamespaces,
                      *uris.begin() + " and " + *std::next(uris.begin()));
    }
    if (uris.empty() || uris.begin()->empty() || *uris.begin() == standard_namespace) {
        return refuse(ModelCode::NoNamespace, uris.empty() ? std::string{} : *uris.begin());
    }
    ModelHeader header;
    header.model.uri = *uris.begin();
    header.named = std::move(named);
    for (const pugi::xml_node& model : models) {
        header.model = model_of(model);
        for (const pugi::xml_node& required : model.children()) {
            if (local_name(required) == "RequiredModel" && header.required.size() < max_models) {
                header.required.push_back(model_of(required));
            }
        }
    }
    return header;
}

Expected<std::string, ModelReport> read_source(const model::NodeSetSource& source,
                                               std::uint64_t max_size)
{
    const auto refuse = [&](ModelCode code, std::string found) {
        return Unexpected{ModelReport{code, {}, printable(source.name), std::move(found)}};
    };
    const std::string too_large = "more than " + std::to_string(max_size) + " bytes";
    if (source.text) {
        return source.text->size() <= max_size ? Expected<std::string, ModelReport>{*source.text}
                                               : refuse(ModelCode::FilesTooLarge, too_large);
    }
    std::ifstream file{source.name, std::ios::binary};
    std::string text;
    constexpr std::size_t piece = 64U << 10U;
    while (file && text.size() <= max_size) {
        const std::size_t before = text.size();
        text.resize(before + piece);
        file.read(text.data() + before, static_cast<std::streamsize>(piece));
        text.resize(before + static_cast<std::size_t>(file.gcount()));
    }
    if (text.size() > max_size) {
        return refuse(ModelCode::FilesTooLarge, too_large);
    }
    if (!file.eof() || file.bad()) {
        return refuse(ModelCode::FileUnreadable, {});
    }
    return text;
}

} // namespace busbar::controller::detail
