#include "model_state.hpp"

#include <algorithm>
#include <charconv>
#include <compare>
#include <cstdint>
#include <optional>

#include <busbar/controller/mapping_extensions.hpp>
#include <busbar/core/text.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/types/ids.hpp>

#include "extension_attributes.hpp"

namespace busbar::controller {

namespace {

using detail::HeaderModel;

/// Describes a namespace by the NamespaceMetadata in the AddressSpace (Part 5, 6.3.14).
HeaderModel metadata_of(const model::SpaceReader& space, const std::string& uri)
{
    HeaderModel result{uri, {}, {}, {}};
    const model::NodeIndex all = space.find(id::Server_Namespaces);
    if (all == model::no_node) {
        return result;
    }
    const model::NodeIndex any = space.find(id::HierarchicalReferences);
    const auto find = [&](model::NodeIndex parent, const std::string& name) {
        model::NodeIndex found = model::no_node;
        space.for_each_child(parent, any, true, QualifiedName{0, String{name}},
                             [&](model::NodeIndex child) {
                                 found = child;
                                 return false;
                             });
        return found;
    };
    const model::NodeIndex metadata = find(all, uri);
    const model::NodeIndex version =
        metadata == model::no_node ? metadata : find(metadata, "NamespaceVersion");
    if (version != model::no_node) {
        result.version = space.value(version).value_or(String{}).str();
    }
    return result;
}

/// Compares versions by the numbers between their periods; unordered if they differ in another way.
std::partial_ordering compare_versions(std::string_view one, std::string_view other)
{
    if (one == other) {
        return std::partial_ordering::equivalent;
    }
    const auto take = [](std::string_view& text) -> std::optional<std::uint32_t> {
        const std::size_t end = std::min(text.find('.'), text.size());
        std::uint32_t number = 0;
        const auto read = std::from_chars(text.data(), text.data() + end, number);
        const bool is_number = read.ec == std::errc{} && read.ptr == text.data() + end;
        text.remove_prefix(std::min(end + 1, text.size()));
        return is_number ? std::optional{number} : std::nullopt;
    };
    while (!one.empty() || !other.empty()) {
        const auto left = one.empty() ? 0 : take(one);
        const auto right = other.empty() ? 0 : take(other);
        if (!left || !right) {
            return std::partial_ordering::unordered;
        }
        if (*left != *right) {
            return *left <=> *right;
        }
    }
    return std::partial_ordering::equivalent;
}

std::partial_ordering compare_dates(const std::string& one, const std::string& other)
{
    const auto left = parse_date_time(one);
    const auto right = parse_date_time(other);
    return left && right ? std::partial_ordering{left->ticks <=> right->ticks}
                         : std::partial_ordering::unordered;
}

/// Compares what is there with what is asked for: by ModelVersion, without which a model is the
/// older one, then by PublicationDate (Part 6, F.2). Version is a text for people, and counts only
/// if one of them has no date.
std::partial_ordering compare_models(const HeaderModel& there, const HeaderModel& asked)
{
    if (there.model_version.empty() != asked.model_version.empty()) {
        return asked.model_version.empty() ? std::partial_ordering::greater
                                           : std::partial_ordering::less;
    }
    if (const auto compared = compare_versions(there.model_version, asked.model_version);
        compared != 0) {
        return compared;
    }
    if (!there.publication_date.empty() && !asked.publication_date.empty()) {
        return compare_dates(there.publication_date, asked.publication_date);
    }
    return there.version.empty() || asked.version.empty()
               ? std::partial_ordering::equivalent
               : compare_versions(there.version, asked.version);
}

ModelState state_of(const HeaderModel& asked, const HeaderModel& there)
{
    const bool is_standard = asked.uri == "http://opcfoundation.org/UA/"; // has metadata, no header
    const auto compared =
        is_standard ? compare_versions(there.version, asked.version) : compare_models(there, asked);
    return compared == 0  ? ModelState::Imported
           : compared > 0 ? ModelState::LaterVersion
                          : ModelState::OtherVersion;
}

model::NodeSetLimits nodeset_limits(const ModelLimits& limits)
{
    model::NodeSetLimits result = model::limits_for_large_models();
    result.max_file_size = static_cast<std::size_t>(
        std::min<std::uint64_t>(result.max_file_size, limits.max_file_size));
    // Allow one more than fits, so that the excess is reported as such.
    result.max_nodes = std::min(result.max_nodes, limits.max_nodes + 1);
    result.accepts_older_models = true;
    return result;
}

} // namespace

void note_defects(const model::NodeSetSummary& summary, ModelReports& reports)
{
    for (const Problem& note : summary.notes) {
        reports.add({ModelCode::FileNote, {}, printable(note.where, 512), printable(note.text)});
    }
    for (const model::NodeSetRepair& repair : summary.repairs) {
        reports.add({ModelCode::FileRepaired,
                     {},
                     printable(repair.done.where, 512),
                     printable(repair.done.text) + " (rule " +
                         std::string{model::name(repair.rule)} + ")"});
    }
}

bool ModelSet::State::load(std::size_t imported, model::NodeSetSummary& summary,
                           ModelReports& reports)
{
    built_in = space.node_count();
    // Keep the order of files, whatever namespaces they name earlier.
    if (!application_uri.empty()) {
        static_cast<void>(space.add_namespace(application_uri));
    }
    for (const ModelFile& file : files) {
        static_cast<void>(space.add_namespace(file.uri));
    }
    for (std::size_t i = 0; i < files.size(); ++i) {
        const model::NodeSetSource source{files[i].name, files[i].text, files[i].is_lenient};
        auto loaded = model::load_nodesets(space, {&source, 1}, nodeset_limits(limits));
        if (!loaded) {
            const ModelCode code =
                i == imported ? ModelCode::FileInvalid : ModelCode::DependentInvalid;
            for (const Problem& problem : loaded.error()) {
                reports.add({code, {}, printable(problem.where, 512), printable(problem.text)});
            }
            return false;
        }
        if (i == imported) {
            summary = *loaded;
        }
        keep(loaded->extras);
    }
    list_namespaces();
    return true;
}

void ModelSet::State::keep(model::NodeSetExtras& loaded)
{
    for (auto& model : loaded.models) {
        extras.models.push_back(std::move(model));
    }
    extras.nodes.merge(loaded.nodes);
    extras.file_extensions.merge(loaded.file_extensions);
}

void ModelSet::State::note_versions(std::string_view imported, ModelReports& reports) const
{
    for (const ModelNamespace& each : namespaces) {
        for (const RequiredModelStatus& required : each.required) {
            if (required.state == ModelState::OtherVersion &&
                (each.uri == imported || required.uri == imported)) {
                reports.add({ModelCode::ModelOfOtherVersion,
                             {},
                             printable(each.uri),
                             printable(required.uri + ' ' + required.version)});
            }
        }
    }
}

bool ModelSet::State::has_file(std::string_view uri) const
{
    return std::any_of(files.begin(), files.end(),
                       [&](const ModelFile& each) { return each.uri == uri; });
}

bool ModelSet::State::can_add(const ModelFile& file, const detail::ModelHeader& header) const
{
    const std::size_t own = application_uri.empty() ? 1 : 2;
    const bool is_within_limits =
        files.size() < limits.max_files && file_size() + file.text.size() <= limits.max_file_size &&
        files.size() < limits.max_namespaces && node_count() < limits.max_nodes &&
        detail::character_count(file.uri) <= limits.max_uri_length;
    const bool is_next = space.namespace_count() == own + files.size() &&
                         !space.namespace_index(file.uri) && file.uri != application_uri;
    return is_within_limits && is_next &&
           std::all_of(header.named.begin(), header.named.end(),
                       [&](const std::string& uri) {
                           return uri == file.uri || space.namespace_index(uri).has_value();
                       }) &&
           std::all_of(header.required.begin(), header.required.end(),
                       [&](const HeaderModel& each) {
                           return each.uri == space.namespace_uri(0) || has_file(each.uri);
                       });
}

std::optional<ImportResult> ModelSet::State::add(ModelFile& file, detail::ModelHeader& header)
{
    if (!can_add(file, header)) {
        return std::nullopt;
    }
    model::NodeSetLimits allowed = nodeset_limits(limits);
    allowed.max_nodes = std::min(allowed.max_nodes, limits.max_nodes - node_count());
    model::NodeSetSource source{file.name, std::move(file.text), file.is_lenient};
    auto loaded = model::load_nodesets(space, {&source, 1}, allowed);
    file.text = *std::move(source.text);
    if (!loaded) {
        return std::nullopt;
    }
    static_cast<void>(space.add_namespace(file.uri)); // if it has no nodes
    ImportResult result{file.uri, loaded->node_count, false, {}, model::counted_repairs(*loaded)};
    note_defects(*loaded, result.reports);
    list_namespace(header);
    note_versions(file.uri, result.reports);
    ReadMapping read = read_mapping(space, loaded->extras, file.name, limits);
    result.reports.add(std::move(read.reports));
    for (auto& [id, each] : read.mapping.variables) {
        mapping.variables.insert_or_assign(id, std::move(each));
    }
    for (auto& [id, each] : read.mapping.methods) {
        mapping.methods.insert_or_assign(id, std::move(each));
    }
    keep(loaded->extras);
    files.push_back(std::move(file));
    headers.push_back(std::move(header));
    return result;
}

void ModelSet::State::list_namespaces()
{
    const std::string standard{space.namespace_uri(0)};
    namespaces.push_back(
        {0, standard, metadata_of(space, standard).version, {}, ModelState::Imported, {}});
    for (const detail::ModelHeader& header : headers) {
        list_namespace(header);
    }
}

void ModelSet::State::list_namespace(const detail::ModelHeader& header)
{
    ModelNamespace entry{space.namespace_index(header.model.uri).value_or(0),
                         header.model.uri,
                         header.model.version,
                         header.model.publication_date,
                         ModelState::Imported,
                         {}};
    for (const HeaderModel& required : header.required) {
        const ModelState state = state_of_required(required);
        entry.required.push_back(
            {required.uri, required.version, required.publication_date, state});
        entry.state = std::max(entry.state, state);
    }
    namespaces.push_back(std::move(entry));
}

ModelState ModelSet::State::state_of_required(const HeaderModel& required) const
{
    if (required.uri == namespaces.front().uri) {
        const ModelNamespace& standard = namespaces.front();
        return state_of(required, {standard.uri, standard.version, {}, {}});
    }
    const auto there = std::find_if(headers.begin(), headers.end(), [&](const auto& each) {
        return each.model.uri == required.uri;
    });
    return there == headers.end() ? ModelState::OtherVersion : state_of(required, there->model);
}

std::uint64_t ModelSet::State::file_size() const
{
    std::uint64_t size = 0;
    for (const ModelFile& file : files) {
        size += file.text.size();
    }
    return size;
}

} // namespace busbar::controller
