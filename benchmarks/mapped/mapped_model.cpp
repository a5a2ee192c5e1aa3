#include "mapped_model.hpp"

#include <algorithm>

#include <busbar/controller/mapping_extensions.hpp>

namespace busbar::bench {

namespace {

std::string head(const std::string& uri)
{
    return "<UANodeSet xmlns=\"http://opcfoundation.org/UA/2011/03/UANodeSet.xsd\">\n"
           "<NamespaceUris><Uri>" +
           uri + "</Uri></NamespaceUris>\n<Models><Model ModelUri=\"" + uri +
           "\" Version=\"1\"/></Models>\n";
}

/// Tag and attributes of a node, its name, and where it stands.
std::string node(const std::string& tag, const std::string& name, const std::string& attributes,
                 const std::string& parent, const char* type)
{
    return "<" + tag + " NodeId=\"ns=1;s=" + name + "\" BrowseName=\"1:" + name + "\"" +
           attributes + "><DisplayName>" + name +
           "</DisplayName><References><Reference ReferenceType=\"i=40\">" + type +
           "</Reference><Reference ReferenceType=\"i=47\" IsForward=\"false\">" + parent +
           "</Reference></References>";
}

std::string variable(std::size_t number, const std::string& parent, bool is_mapped)
{
    const std::string name = mapped_name(number);
    std::string text =
        node("UAVariable", name, " DataType=\"i=4\" AccessLevel=\"3\"", parent, "i=63");
    if (is_mapped) {
        text += "<Extensions><Extension xmlns=\"" + std::string{controller::mapping_namespace} +
                "\"><DataMapping Data=\"" + name + "\"/></Extension></Extensions>";
    }
    return text + "</UAVariable>\n";
}

std::string object(const std::string& name, const std::string& parent)
{
    return node("UAObject", name, {}, parent, "i=58") + "</UAObject>\n";
}

void add_object(std::string& text, const MappedModel& model, std::size_t number)
{
    const std::string name = "Object" + std::to_string(number);
    text += object(name, "i=85");
    for (std::size_t i = 0; i < model.fillers; ++i) {
        text += object(name + "_" + std::to_string(i), "ns=1;s=" + name);
    }
    for (std::size_t i = 0; i < model.variables; ++i) {
        text += variable(number * model.variables + i, "ns=1;s=" + name, model.is_mapped);
    }
}

} // namespace

std::string mapped_name(std::size_t number)
{
    return (number % 2 == 0 ? "M" : "S") + std::to_string(number / 2);
}

std::vector<controller::ProjectModel> model_files(const MappedModel& model)
{
    std::vector<controller::ProjectModel> files;
    const std::size_t share = (model.objects + model.files - 1) / model.files;
    for (std::size_t first = 0; first < model.objects; first += share) {
        const std::string number = std::to_string(files.size() + 1);
        std::string text = head("urn:busbar:bench:" + number);
        for (std::size_t i = first; i < std::min(first + share, model.objects); ++i) {
            add_object(text, model, i);
        }
        files.push_back({"Bench" + number + ".xml", text + "</UANodeSet>\n"});
    }
    return files;
}

} // namespace busbar::bench
