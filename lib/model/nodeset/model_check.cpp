#include "load_plan.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include <busbar/core/text_forms.hpp>
#include <busbar/types/ids.hpp>

#include "xml_text.hpp"

namespace busbar::nodeset {

namespace {

/// Reads "1.5.7" as numbers, without a suffix such as "-rc1". Returns nothing for any other text.
std::optional<std::array<std::uint32_t, 3>> parse_version(std::string_view text)
{
    std::array<std::uint32_t, 3> version{};
    text = text.substr(0, text.find_first_of("-+"));
    for (std::uint32_t& part : version) {
        const std::size_t point = text.find('.');
        if (!to_number(text.substr(0, point), part)) {
            return std::nullopt;
        }
        if (point == std::string_view::npos) {
            return version;
        }
        text.remove_prefix(point + 1);
    }
    return std::nullopt;
}

/// True if `there` satisfies `required`. ModelVersions are compared if both have one, else the
/// dates of publication; Version is for people.
bool is_recent_enough(const Model& required, const Model& there)
{
    const auto needed_version = parse_version(required.model_version);
    const auto version = parse_version(there.model_version);
    if (needed_version && version) {
        return *version >= *needed_version;
    }
    const auto needed_date = parse_date_time(trimmed(required.publication_date));
    const auto date = parse_date_time(trimmed(there.publication_date));
    return !needed_date || !date || *date >= *needed_date;
}

std::string described(const Model& model)
{
    std::string text = quoted(model.uri);
    const auto add = [&](const char* what, const std::string& value) {
        if (!value.empty()) {
            text += std::string{" "} + what + ' ' + printable(value, 40);
        }
    };
    add("Version", model.version);
    add("ModelVersion", model.model_version);
    add("of", model.publication_date);
    return text;
}

model::NodeIndex child_named(const model::SpaceReader& space, model::NodeIndex parent,
                             std::string_view name)
{
    model::NodeIndex result = model::no_node;
    static_cast<void>(space.for_each_child(parent, space.find(id::HierarchicalReferences), true,
                                           QualifiedName{0, String{name}},
                                           [&](model::NodeIndex child) {
                                               result = child;
                                               return false;
                                           }));
    return result;
}

/// Returns the model that NamespaceMetadata (Part 5, 6.3.14) of the AddressSpace describe.
Model model_in_space(const model::SpaceReader& space, const std::string& uri)
{
    Model result;
    result.uri = uri;
    const model::NodeIndex all = space.find(id::Server_Namespaces);
    if (all == model::no_node) {
        return result;
    }
    model::ReferenceCursor cursor = space.references(all);
    while (const auto reference = cursor.next()) {
        if (!reference->is_forward || space.browse_name(reference->target).name != String{uri}) {
            continue;
        }
        const auto value = [&](std::string_view name) {
            const model::NodeIndex property = child_named(space, reference->target, name);
            return property == model::no_node ? Variant{} : space.value(property);
        };
        result.version = value("NamespaceVersion").value_or(String{}).str();
        result.model_version = value("ModelVersion").value_or(String{}).str();
        const DateTime date = value("NamespacePublicationDate").value_or(DateTime{});
        result.publication_date = date.is_null() ? "" : date_time_text(date);
    }
    return result;
}

const Model* model_in_files(const Document& document, const std::string& uri)
{
    const auto& models = document.models();
    const auto found = std::find_if(models.begin(), models.end(),
                                    [&](const Model& model) { return model.uri == uri; });
    return found == models.end() ? nullptr : &*found;
}

} // namespace

std::vector<Problem> missing_models(Document& document, const model::SpaceReader& space)
{
    std::vector<Problem> errors;
    for (const Model& model : document.models()) {
        for (const Model& required : model.required) {
            const File& file = document.files()[required.file];
            const std::string asked =
                "the model " + quoted(model.uri) + " requires " + described(required) + ", found ";
            const auto fail = [&](const std::string& found) {
                errors.push_back(problem_at(file.name, required.line, asked + found));
            };
            const Model* const in_files = model_in_files(document, required.uri);
            const bool is_in_space = space.namespace_index(required.uri).has_value();
            if (in_files == nullptr && !is_in_space) {
                fail("it in no file and not in the address space");
                continue;
            }
            // A file cannot replace the AddressSpace's own model.
            const Model there = is_in_space ? model_in_space(space, required.uri) : *in_files;
            if (document.limits().accepts_older_models || is_recent_enough(required, there)) {
                continue;
            }
            if (file.is_lenient) {
                document.add_repair(model::NodeSetRule::OlderModel,
                                    problem_at(file.name, required.line,
                                               asked + described(there) + ", and went on"));
            } else {
                fail(described(there));
            }
        }
    }
    return errors;
}

} // namespace busbar::nodeset
