#pragma once

#include <optional>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/model/nodeset.hpp>
#include <busbar/types/ids.hpp>
#include <model/space_hash.hpp>

namespace busbar::model {

/// A NodeSet2 file of the namespace "urn:t" (ns=1), the first node in line 3.
[[nodiscard]] inline std::string nodeset_text(const std::string& content)
{
    return "<UANodeSet xmlns=\"http://opcfoundation.org/UA/2011/03/UANodeSet.xsd\">"
           "<NamespaceUris><Uri>urn:t</Uri></NamespaceUris>\n<Aliases>"
           "<Alias Alias=\"HasSubtype\">i=45</Alias></Aliases>\n" +
           content + "</UANodeSet>";
}

/// A Variable of namespace 1 below the Objects folder.
[[nodiscard]] inline std::string variable_text(const std::string& id, const std::string& attributes,
                                               const std::string& value)
{
    return "<UAVariable NodeId=\"ns=1;" + id + "\" BrowseName=\"1:" + id + "\" " + attributes +
           "><References><Reference ReferenceType=\"i=35\" IsForward=\"false\">i=85</Reference>"
           "<Reference ReferenceType=\"i=40\">i=63</Reference></References><Value>" +
           value + "</Value></UAVariable>\n";
}

/// A type of namespace 1 below another.
[[nodiscard]] inline std::string type_text(const std::string& element, const std::string& id,
                                           const std::string& supertype,
                                           const std::string& content = {})
{
    return "<" + element + " NodeId=\"ns=1;" + id + "\" BrowseName=\"1:T" + id.substr(2) +
           "\"><References><Reference ReferenceType=\"HasSubtype\" IsForward=\"false\">" +
           supertype + "</Reference></References>" + content + "</" + element + ">\n";
}

/// A field of a DataType's Definition.
[[nodiscard]] inline std::string field_text(const std::string& name, const std::string& type,
                                            const std::string& attributes = {})
{
    return "<Field Name=\"" + name + "\" DataType=\"" + type + "\" " + attributes + "/>";
}

/// A DataType with the Definition "T".
[[nodiscard]] inline std::string structure_text(const std::string& id, const std::string& supertype,
                                                const std::string& fields,
                                                const std::string& attributes = {})
{
    return type_text("UADataType", id, supertype,
                     "<Definition Name=\"T\" " + attributes + ">" + fields + "</Definition>");
}

/// An Object with the Default Binary encoding of a DataType.
[[nodiscard]] inline std::string encoding_text(const std::string& id, const std::string& type)
{
    return "<UAObject NodeId=\"ns=1;" + id +
           "\" BrowseName=\"Default Binary\" SymbolicName=\"DefaultBinary\"><References>"
           "<Reference ReferenceType=\"i=38\" IsForward=\"false\">ns=1;" +
           type +
           "</Reference><Reference ReferenceType=\"i=40\">i=76</Reference></References>"
           "</UAObject>\n";
}

/// An AddressSpace and verbs that load NodeSet2 files into it.
struct NodeSetFixture {
    AddressSpace space;

    NodeSetFixture() = default;
    NodeSetFixture(const NodeSetFixture&) = delete;
    NodeSetFixture& operator=(const NodeSetFixture&) = delete;
    ~NodeSetFixture() { check_unchanged(); }

    NodeSetSummary load(const std::vector<NodeSetSource>& sources, const NodeSetLimits& limits = {})
    {
        check_unchanged();
        auto loaded = load_nodesets(space, sources, limits);
        for (const Problem& problem : loaded ? std::vector<Problem>{} : loaded.error()) {
            UNSCOPED_INFO(busbar::text(problem));
        }
        REQUIRE(loaded);
        return std::move(*loaded);
    }
    NodeSetSummary load(const std::string& content)
    {
        return load({{"t.xml", nodeset_text(content)}});
    }
    /// Returns the first error's text. The AddressSpace must stay as it was before the first of
    /// several errors, which is checked before the next load() and at the end, as it takes longer
    /// than to find the error.
    [[nodiscard]] std::string error_of(const std::vector<NodeSetSource>& sources,
                                       const NodeSetLimits& limits = {})
    {
        if (!hash_) {
            hash_ = space.namespace_count() == 1 ? hash_of_namespace0() : detail::space_hash(space);
        }
        const auto loaded = load_nodesets(space, sources, limits);
        return loaded ? std::string{} : busbar::text(loaded.error().front());
    }
    [[nodiscard]] std::string error_of(const std::string& content, const NodeSetLimits& limits = {})
    {
        return error_of(std::vector<NodeSetSource>{{"t.xml", nodeset_text(content)}}, limits);
    }
    [[nodiscard]] NodeIndex find(const std::string& id) const
    {
        auto node = NodeId::parse(id).value();
        node.set_namespace_index(*space.namespace_index("urn:t"));
        return space.find(node);
    }
    [[nodiscard]] Variant value(const std::string& id) const { return space.value(find(id)); }

private:
    /// The facts of every AddressSpace that nothing was added to.
    [[nodiscard]] static std::uint64_t hash_of_namespace0()
    {
        static const std::uint64_t hash = detail::space_hash(AddressSpace{});
        return hash;
    }
    void check_unchanged()
    {
        if (hash_) {
            CHECK(detail::space_hash(space) == *hash_);
            hash_.reset();
        }
    }

    std::optional<std::uint64_t> hash_;
};

/// Writes the namespaces, reads them into `base`, and compares the nodes, and the extras unless
/// namespaces have other indices there.
inline void check_write_back(const AddressSpace& space, AddressSpace base,
                             const std::vector<std::uint16_t>& namespaces,
                             const NodeSetSummary& summary, bool has_same_namespaces = true)
{
    if (has_same_namespaces) {
        for (std::uint16_t i = 1; i < space.namespace_count(); ++i) {
            REQUIRE(base.add_namespace(space.namespace_uri(i)));
        }
    }
    const auto text = write_nodeset(space, namespaces, summary.extras);
    REQUIRE(text);
    const auto loaded = load_nodesets(base, std::vector{NodeSetSource{"written.xml", *text}});
    for (const Problem& problem : loaded ? std::vector<Problem>{} : loaded.error()) {
        UNSCOPED_INFO(busbar::text(problem));
    }
    INFO(text->substr(0, 20'000));
    REQUIRE(loaded);
    CHECK((!has_same_namespaces || loaded->extras.nodes == summary.extras.nodes));
    CHECK((!has_same_namespaces || loaded->extras.models == summary.extras.models));
    // Those of all files are the one's that was written.
    CHECK((summary.extras.file_extensions.size() > 1 ||
           loaded->extras.file_extensions == summary.extras.file_extensions));
    for (const std::uint16_t index : namespaces) {
        const auto again = base.namespace_index(space.namespace_uri(index));
        REQUIRE(again);
        CHECK(detail::space_hash(base, *again) == detail::space_hash(space, index));
    }
}

} // namespace busbar::model
