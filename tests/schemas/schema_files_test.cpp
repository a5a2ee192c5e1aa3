#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <pugixml.hpp>

namespace schema_files_test {

// What holds of the files in schemas/ without anything to compare them with.
namespace {

namespace fs = std::filesystem;
using Ids = std::set<unsigned>;

const fs::path schemas = BUSBAR_SOURCE_DIR "/schemas";

unsigned number_of(std::string_view id)
{
    unsigned result = 0;
    if (id.starts_with("i=")) {
        std::from_chars(id.data() + 2, id.data() + id.size(), result);
    }
    return result;
}

std::vector<fs::path> nodeset_files(const fs::path& folder = schemas)
{
    std::vector<fs::path> result;
    for (const auto& entry : fs::directory_iterator{folder}) {
        if (entry.path().extension() == ".xml") {
            result.push_back(entry.path());
        }
    }
    std::sort(result.begin(), result.end());
    return result;
}

struct Node {
    std::string element;
    Ids needed; ///< type definition, data types, encodings, modelling rule
    Ids properties;
    Ids parents; ///< of a type its supertypes

    [[nodiscard]] bool is_type() const { return element.ends_with("Type"); }
};

class Nodes {
public:
    Nodes()
    {
        for (const fs::path& file : nodeset_files()) {
            pugi::xml_document document;
            REQUIRE(document.load_file(file.c_str()));
            for (const pugi::xml_node element : document.child("UANodeSet")) {
                if (element.attribute("NodeId")) {
                    add(element);
                }
            }
        }
    }

    [[nodiscard]] const Node* find(unsigned id) const
    {
        const auto found = nodes_.find(id);
        return found == nodes_.end() ? nullptr : &found->second;
    }

private:
    void add(pugi::xml_node element)
    {
        const unsigned id = number_of(element.attribute("NodeId").value());
        Node& node = nodes_[id];
        CHECK(node.element.empty()); // defined once
        node.element = element.name();
        if (const auto data_type = element.attribute("DataType")) {
            node.needed.insert(number_of(data_type.value()));
        }
        for (const pugi::xml_node field : element.child("Definition")) {
            if (const auto data_type = field.attribute("DataType")) {
                node.needed.insert(number_of(data_type.value()));
            }
        }
        for (const pugi::xml_node reference : element.child("References")) {
            const unsigned target = number_of(reference.text().get());
            const bool is_forward = reference.attribute("IsForward").as_bool(true);
            add_reference(is_forward ? id : target,
                          number_of(reference.attribute("ReferenceType").value()),
                          is_forward ? target : id);
        }
    }

    void add_reference(unsigned from, unsigned type, unsigned to)
    {
        switch (type) {
        case 37: // HasModellingRule
        case 40: // HasTypeDefinition
            nodes_[from].needed.insert(to);
            break;
        case 38: // HasEncoding
            nodes_[from].needed.insert(to);
            nodes_[to].parents.insert(from);
            break;
        case 46: // HasProperty
            nodes_[from].properties.insert(to);
            [[fallthrough]];
        case 35: // Organizes
        case 36: // HasEventSource
        case 45: // HasSubtype
        case 47: // HasComponent
        case 48: // HasNotifier
        case 49: // HasOrderedComponent
            nodes_[to].parents.insert(from);
            break;
        default:
            break;
        }
    }

    std::map<unsigned, Node> nodes_;
};

Ids read_list(const std::string& size)
{
    std::ifstream file{schemas / "sizes" / (size + ".txt")};
    Ids result;
    unsigned last = 0;
    for (unsigned id = 0; file >> id; last = id) {
        CHECK(id > last); // sorted, each once
        result.insert(id);
    }
    CHECK(file.eof());
    return result;
}

/// UrisVersion, LocalTime, RedundantServerArray of the Server and of its type, NamespaceFile:
/// optional, and left out on purpose.
const Ids left_out = {15003, 15004, 17612, 17634, 11313, 32410, 11624};
/// Root, the tops of the type hierarchies, the modelling rules.
const Ids without_parent = {84, 24, 31, 58, 62, 78, 80, 83, 11508};

void check_closed(const Nodes& nodes, const Ids& list, unsigned id, bool has_bare_types)
{
    INFO("i=" << id);
    const Node* node = nodes.find(id);
    REQUIRE(node != nullptr);
    const auto is_listed = [&](unsigned other) { return list.count(other) != 0; };
    CHECK(std::all_of(node->needed.begin(), node->needed.end(), is_listed));
    if (without_parent.count(id) == 0) {
        CHECK(std::any_of(node->parents.begin(), node->parents.end(), is_listed));
    }
    if (has_bare_types && node->is_type() && node->element != "UADataType") {
        return;
    }
    for (const unsigned property : node->properties) {
        CHECK((is_listed(property) || left_out.count(property) != 0));
    }
}

} // namespace

TEST_CASE("Schema files are small and hold facts only")
{
    std::vector<fs::path> files = nodeset_files();
    const std::vector<fs::path> companions = nodeset_files(schemas / "companion");
    CHECK(companions.size() >= 2);
    files.insert(files.end(), companions.begin(), companions.end());
    for (const fs::path& file : files) {
        INFO(file);
        CHECK(fs::file_size(file) < 1024U * 1024U);
        pugi::xml_document document;
        REQUIRE(document.load_file(file.c_str()));
        for (const char* name : {"Description", "Documentation", "Extensions"}) {
            const auto found = document.find_node([&](pugi::xml_node node) {
                const std::string_view text{node.name()};
                const auto colon = text.find(':');
                return text.substr(colon == std::string_view::npos ? 0 : colon + 1) == name;
            });
            CHECK_FALSE(found);
        }
    }
}

TEST_CASE("References lead to nodes of the schema")
{
    const Nodes nodes;
    for (const char* size : {"micro", "embedded", "standard"}) {
        CHECK_FALSE(read_list(size).empty());
    }
    for (const fs::path& file : nodeset_files()) {
        pugi::xml_document document;
        REQUIRE(document.load_file(file.c_str()));
        for (const pugi::xpath_node found : document.select_nodes("//Reference")) {
            INFO(file << ": " << found.node().text().get());
            const Node* target = nodes.find(number_of(found.node().text().get()));
            CHECK((target != nullptr && !target->element.empty()));
        }
    }
}

TEST_CASE("The sizes of namespace 0 are closed and contain each other")
{
    const Nodes nodes;
    Ids smaller;
    for (const char* size : {"micro", "embedded", "standard"}) {
        INFO(size);
        const Ids list = read_list(size);
        for (const unsigned id : list) {
            check_closed(nodes, list, id, size == std::string_view{"micro"});
        }
        CHECK(std::includes(list.begin(), list.end(), smaller.begin(), smaller.end()));
        smaller = list;
    }
}

} // namespace schema_files_test
