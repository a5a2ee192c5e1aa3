#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/controller/mapping_extensions.hpp>
#include <busbar/controller/model_set.hpp>

namespace busbar::controller {

/// A node's <Extensions> with one mapping; `mapping` is an element without its xmlns.
[[nodiscard]] inline std::string extension(std::string mapping)
{
    const std::size_t end = mapping.find_first_of(" />");
    mapping.insert(end, " xmlns=\"" + std::string{mapping_namespace} + '"');
    return "<Extensions><Extension>" + mapping + "</Extension></Extensions>";
}

/// A Variable of namespace 1 below Objects.
[[nodiscard]] inline std::string variable(const std::string& id, const std::string& content = {},
                                          const std::string& attributes = "DataType=\"i=6\"")
{
    return "<UAVariable NodeId=\"ns=1;" + id + "\" BrowseName=\"1:" + id.substr(2) + "\" " +
           attributes +
           "><References><Reference ReferenceType=\"i=35\" IsForward=\"false\">i=85</Reference>"
           "<Reference ReferenceType=\"i=40\">i=63</Reference></References>" +
           content + "</UAVariable>\n";
}

/// A Method of namespace 1 below Objects.
[[nodiscard]] inline std::string method(const std::string& id, const std::string& content = {})
{
    return "<UAMethod NodeId=\"ns=1;" + id + "\" BrowseName=\"1:" + id.substr(2) +
           "\"><References><Reference ReferenceType=\"i=47\" IsForward=\"false\">ns=1;s=Cell"
           "</Reference></References>" +
           content + "</UAMethod>\n";
}

/// An Object "Cell" of namespace 1 below Objects.
[[nodiscard]] inline std::string cell()
{
    return "<UAObject NodeId=\"ns=1;s=Cell\" BrowseName=\"1:Cell\"><References>"
           "<Reference ReferenceType=\"i=35\" IsForward=\"false\">i=85</Reference>"
           "<Reference ReferenceType=\"i=40\">i=58</Reference></References></UAObject>\n";
}

[[nodiscard]] inline std::string required(const std::string& uri, const std::string& version = "1")
{
    return "<RequiredModel ModelUri=\"" + uri + "\" Version=\"" + version + "\"/>";
}

/// A NodeSet2 file of one namespace, which is ns=1 in it.
[[nodiscard]] inline std::string file(const std::string& uri, const std::string& nodes,
                                      const std::string& requires_models = {},
                                      const std::string& further_uris = {},
                                      const std::string& version = "1")
{
    return "<UANodeSet xmlns=\"http://opcfoundation.org/UA/2011/03/UANodeSet.xsd\">"
           "<NamespaceUris><Uri>" +
           uri + "</Uri>" + further_uris + "</NamespaceUris><Models><Model ModelUri=\"" + uri +
           "\" Version=\"" + version + "\">" + requires_models + "</Model></Models>\n" + nodes +
           "</UANodeSet>";
}

[[nodiscard]] inline bool has(const ModelReports& reports, ModelCode code)
{
    return std::any_of(reports.list().begin(), reports.list().end(),
                       [&](const ModelReport& report) { return report.code == code; });
}

[[nodiscard]] inline std::string lines(const ModelReports& reports)
{
    std::string all;
    for (const ModelReport& report : reports.list()) {
        all += text(report) + '\n';
    }
    return all;
}

/// A project and verbs.
struct ModelFixture {
    ModelSet models;

    explicit ModelFixture(const ModelLimits& limits = {}) : models{limits} {}

    ImportResult import(const std::string& text, const std::string& name = "t.xml")
    {
        auto result = models.import({name, text});
        UNSCOPED_INFO((result ? std::string{} : lines(result.error())));
        REQUIRE(result);
        return std::move(*result);
    }
    /// The reports of an import that must fail and change nothing.
    ModelReports refusal(const std::string& text, const std::string& name = "t.xml")
    {
        const auto namespaces = models.namespaces();
        const Mapping mapping = models.mapping();
        const std::size_t nodes = models.space().node_count();
        auto result = models.import({name, text});
        REQUIRE_FALSE(result);
        CHECK(result.error().has_errors());
        CHECK(models.namespaces() == namespaces);
        CHECK(models.mapping() == mapping);
        CHECK(models.space().node_count() == nodes);
        return std::move(result.error());
    }
    [[nodiscard]] NodeId id(const std::string& name, const std::string& uri = "urn:t") const
    {
        const auto index = models.space().namespace_index(uri);
        REQUIRE(index);
        return {*index, String{name}};
    }
    [[nodiscard]] std::string label(const std::string& name, const std::string& uri = "urn:t") const
    {
        const auto found = models.mapping().variables.find(id(name, uri));
        return found == models.mapping().variables.end() ? "" : found->second.value.label;
    }
    void map(const std::string& name, const std::string& label)
    {
        models.mapping().variables[id(name)].value.label = label;
    }
    [[nodiscard]] std::string exported(const std::string& uri = "urn:t") const
    {
        const auto text = models.export_text(uri);
        REQUIRE(text);
        return *text;
    }
};

} // namespace busbar::controller
