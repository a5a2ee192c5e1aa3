#include <algorithm>
#include <array>
#include <utility>

#include <busbar/controller/mapping_extensions.hpp>
#include <busbar/controller/node_roles.hpp>
#include <busbar/core/text.hpp>
#include <busbar/core/text_forms.hpp>

#include "extension_attributes.hpp"
#include "mapping_merge.hpp"
#include "model_state.hpp"

namespace busbar::controller {

/// An import, from the text to the new state.
struct ModelSet::Change {
    State& before;
    State after;
    /// The imported file, until it is placed.
    ModelFile file{};
    detail::ModelHeader header{};
    std::size_t position{0};
    bool is_replacement{false};
    ModelReports reports{};

    [[nodiscard]] bool read(const model::NodeSetSource& source);
    [[nodiscard]] bool place();
    [[nodiscard]] bool check_limits();
    [[nodiscard]] bool check_required();
    [[nodiscard]] bool load(ImportResult& result);

    [[nodiscard]] bool fail(ModelCode code, const std::string& found = {})
    {
        const std::string where =
            position < after.files.size() ? printable(after.files[position].name) : std::string{};
        reports.add({code, {}, where, printable(found)});
        return false;
    }
};

bool ModelSet::Change::read(const model::NodeSetSource& source)
{
    auto text = detail::read_source(source, after.limits.max_file_size);
    if (!text) {
        reports.add(text.error());
        return false;
    }
    auto found = detail::read_header(*text, source.name);
    if (!found) {
        reports.add(found.error());
        return false;
    }
    header = *std::move(found);
    file = {header.model.uri, source.name, *std::move(text), source.is_lenient};
    return true;
}

bool ModelSet::Change::place()
{
    after.files = before.files;
    for (ModelFile& each : after.files) {
        each.text = before.text_of(each);
    }
    after.headers = before.headers;
    const auto found = std::find_if(after.files.begin(), after.files.end(),
                                    [&](const auto& each) { return each.uri == file.uri; });
    position = static_cast<std::size_t>(found - after.files.begin());
    is_replacement = found != after.files.end();
    if (!is_replacement) {
        after.files.emplace_back();
        after.headers.emplace_back();
    }
    after.files[position] = std::move(file);
    after.headers[position] = std::move(header);
    return after.files[position].uri != after.application_uri || fail(ModelCode::StandardNamespace);
}

bool ModelSet::Change::check_limits()
{
    const ModelLimits& limits = after.limits;
    if (after.files.size() > limits.max_files) {
        return fail(ModelCode::TooManyFiles, "more than " + std::to_string(limits.max_files));
    }
    if (after.file_size() > limits.max_file_size) {
        return fail(ModelCode::FilesTooLarge,
                    "more than " + std::to_string(limits.max_file_size) + " bytes");
    }
    const std::size_t length = detail::character_count(after.files[position].uri);
    if (length > limits.max_uri_length) {
        return fail(ModelCode::UriTooLong, std::to_string(length) + " characters");
    }
    return true;
}

bool ModelSet::Change::check_required()
{
    bool is_complete = true;
    for (const detail::HeaderModel& required : after.headers[position].required) {
        const auto end = after.files.begin() + static_cast<std::ptrdiff_t>(position);
        const bool is_there = required.uri == after.space.namespace_uri(0) ||
                              std::any_of(after.files.begin(), end, [&](const ModelFile& each) {
                                  return each.uri == required.uri;
                              });
        if (!is_there) {
            is_complete = fail(ModelCode::ModelMissing, required.uri + ' ' + required.version);
        }
    }
    return is_complete;
}

bool ModelSet::Change::load(ImportResult& result)
{
    model::NodeSetSummary summary;
    if (!after.load(position, summary, reports)) {
        return false;
    }
    const std::size_t own = after.application_uri.empty() ? 1 : 2;
    if (after.space.namespace_count() - own > after.limits.max_namespaces) {
        return fail(ModelCode::TooManyNamespaces,
                    "more than " + std::to_string(after.limits.max_namespaces));
    }
    if (after.node_count() > after.limits.max_nodes) {
        return fail(ModelCode::TooManyNodes, "more than " + std::to_string(after.limits.max_nodes));
    }
    note_defects(summary, reports);
    const ModelFile& placed = after.files[position];
    after.note_versions(placed.uri, reports);
    ReadMapping read = read_mapping(after.space, summary.extras, placed.name, after.limits);
    reports.add(std::move(read.reports));
    after.keep_roles(before, placed.uri, reports);
    after.mapping =
        detail::merge(before.mapping, before.space, std::move(read.mapping),
                      after.space.namespace_index(placed.uri).value_or(0), after.space, reports);
    result = {placed.uri, summary.node_count, is_replacement, std::move(reports),
              model::counted_repairs(summary)};
    return true;
}

ModelSet::ModelSet(const ModelLimits& limits, std::string application_uri)
    : state_{std::make_unique<State>()}
{
    state_->limits = limits;
    state_->application_uri = std::move(application_uri);
    model::NodeSetSummary none;
    ModelReports no_reports;
    static_cast<void>(state_->load(0, none, no_reports));
}

ModelSet::ModelSet(ModelSet&&) noexcept = default;
ModelSet& ModelSet::operator=(ModelSet&&) noexcept = default;
ModelSet::~ModelSet() = default;

Expected<ImportResult, ModelReports> ModelSet::import(const model::NodeSetSource& source)
{
    auto next = std::make_unique<State>();
    next->limits = state_->limits;
    next->application_uri = state_->application_uri;
    Change change{*state_, std::move(*next)};
    if (!change.read(source)) {
        return Unexpected{std::move(change.reports)};
    }
    if (auto added = state_->add(change.file, change.header)) {
        return *std::move(added);
    }
    ImportResult result;
    if (!change.place() || !change.check_limits() || !change.check_required() ||
        !change.load(result)) {
        return Unexpected{std::move(change.reports)};
    }
    state_ = std::make_unique<State>(std::move(change.after));
    return result;
}

Expected<void, ModelReport> ModelSet::remove(std::string_view uri)
{
    const auto refuse = [&](ModelCode code) {
        return Unexpected{ModelReport{code, {}, printable(uri), {}}};
    };
    if (uri == state_->space.namespace_uri(0) || uri == state_->application_uri) {
        return refuse(ModelCode::StandardNamespace);
    }
    const auto& files = state_->files;
    if (std::none_of(files.begin(), files.end(),
                     [&](const ModelFile& file) { return file.uri == uri; })) {
        return refuse(ModelCode::NamespaceUnknown);
    }
    if (files.back().uri != uri) {
        return refuse(ModelCode::NotUndermost);
    }
    auto next = std::make_unique<State>();
    next->limits = state_->limits;
    next->application_uri = state_->application_uri;
    next->files.assign(files.begin(), files.end() - 1);
    for (ModelFile& each : next->files) {
        each.text = state_->text_of(each);
    }
    next->headers.assign(state_->headers.begin(), state_->headers.end() - 1);
    model::NodeSetSummary none;
    ModelReports reports;
    if (!next->load(next->files.size(), none, reports)) {
        return Unexpected{reports.list().front()};
    }
    next->mapping = detail::translate(state_->mapping, state_->space, next->space);
    state_ = std::move(next);
    return {};
}

namespace {

/// Everything but the nodes in a file of one namespace.
struct FileParts {
    model::NodeSetExtras extras{};
    Mapping mapping{};
};

/// Splits these by namespace in one pass, for the namespaces that `wants` accepts.
template <typename Wants>
std::unordered_map<std::uint16_t, FileParts> parts_of(const model::NodeSetExtras& extras,
                                                      const Mapping& mapping, Wants wants)
{
    std::unordered_map<std::uint16_t, FileParts> parts;
    const auto split = [&](const auto& from, auto to) {
        for (const auto& each : from) {
            const std::uint16_t index = each.first.namespace_index();
            if (wants(index)) {
                to(parts[index]).insert(each);
            }
        }
    };
    split(
        extras.nodes, [](FileParts & each) -> auto& { return each.extras.nodes; });
    split(
        mapping.variables, [](FileParts & each) -> auto& { return each.mapping.variables; });
    split(
        mapping.methods, [](FileParts & each) -> auto& { return each.mapping.methods; });
    return parts;
}

Result<std::string> write_file(const model::SpaceReader& space, std::uint16_t index,
                               const model::NodeSetExtras& all, FileParts& parts)
{
    parts.extras.models = all.models;
    parts.extras.file_extensions = all.file_extensions;
    const std::array<std::uint16_t, 1> wanted{index};
    write_mapping(parts.mapping, wanted, parts.extras);
    return model::write_nodeset(space, wanted, parts.extras);
}

} // namespace

Expected<std::string, ModelReport> ModelSet::export_text(std::string_view uri) const
{
    const auto& files = state_->files;
    const auto index = state_->space.namespace_index(uri);
    const auto refuse = [&] {
        return Unexpected{ModelReport{ModelCode::NamespaceUnknown, {}, printable(uri), {}}};
    };
    if (!index || std::none_of(files.begin(), files.end(),
                               [&](const ModelFile& file) { return file.uri == uri; })) {
        return refuse();
    }
    auto parts = parts_of(state_->extras, state_->mapping,
                          [&](std::uint16_t each) { return each == *index; });
    auto text = write_file(state_->space, *index, state_->extras, parts[*index]);
    if (!text) {
        return refuse();
    }
    return std::move(*text);
}

std::string ModelSet::State::text_of(const ModelFile& file) const
{
    const auto index = space.namespace_index(file.uri);
    if (!index || !with_other_roles.contains(*index)) {
        return file.text;
    }
    auto parts = parts_of(extras, mapping, [&](std::uint16_t each) { return each == *index; });
    return write_file(space, *index, extras, parts[*index]).value_or(file.text);
}

void ModelSet::State::keep_roles(const State& before, std::string_view uri, ModelReports& reports)
{
    const auto index = before.space.namespace_index(uri);
    if (!index) {
        return;
    }
    before.space.for_each([&](model::NodeIndex old) {
        const NodeId id = before.space.node_id(old);
        const model::NodeAccess* const had = before.space.node_access(old);
        if (id.namespace_index() != *index || had == nullptr || had->role_permissions.is_null()) {
            return;
        }
        const auto known = detail::translate(id, before.space, space);
        const model::NodeIndex node = known ? space.find(*known) : model::no_node;
        if (node == model::no_node) {
            return;
        }
        const model::NodeAccess* const has = space.node_access(node);
        if (has == nullptr || has->role_permissions.is_null()) {
            set_roles(node, had->role_permissions);
            reports.add({ModelCode::RolesKept, *known, to_string(*known),
                         printable(roles_text(had->role_permissions.span()))});
        } else if (has->role_permissions != had->role_permissions) {
            reports.add({ModelCode::RolesReplaced, *known, to_string(*known),
                         printable(roles_text(had->role_permissions.span()))});
        }
    });
}

void ModelSet::State::set_roles(model::NodeIndex node, Array<RolePermissionType> roles)
{
    const model::NodeAccess* const own = space.node_access(node);
    model::NodeAccess access = own != nullptr ? *own : model::NodeAccess{};
    access.role_permissions = std::move(roles);
    space.set_node_access(node, std::move(access));
    with_other_roles.insert(space.node_id(node).namespace_index());
}

void ModelSet::set_roles(model::NodeIndex node, Array<RolePermissionType> roles)
{
    state_->set_roles(node, std::move(roles));
}

std::vector<std::string> ModelSet::export_texts() const
{
    auto parts = parts_of(state_->extras, state_->mapping, [](std::uint16_t) { return true; });
    std::vector<std::string> texts;
    for (const ModelFile& file : state_->files) {
        // The space has a namespace for every file.
        const std::uint16_t index = state_->space.namespace_index(file.uri).value_or(0);
        texts.push_back(
            write_file(state_->space, index, state_->extras, parts[index]).value_or(file.text));
        parts.erase(index);
    }
    return texts;
}

const std::vector<ModelNamespace>& ModelSet::namespaces() const
{
    return state_->namespaces;
}

const std::vector<ModelFile>& ModelSet::files() const
{
    return state_->files;
}

const model::AddressSpace& ModelSet::space() const
{
    return state_->space;
}

const model::NodeSetExtras& ModelSet::extras() const
{
    return state_->extras;
}

const ModelLimits& ModelSet::limits() const
{
    return state_->limits;
}

const Mapping& ModelSet::mapping() const
{
    return state_->mapping;
}

Mapping& ModelSet::mapping()
{
    return state_->mapping;
}

std::uint64_t ModelSet::file_size() const
{
    return state_->file_size();
}

Expected<Mapping, ModelReports> ModelSet::load_into(model::AddressSpace& space) const
{
    std::vector<model::NodeSetSource> sources;
    for (const ModelFile& file : state_->files) {
        sources.push_back({file.name, state_->text_of(file), file.is_lenient});
    }
    model::NodeSetLimits limits = model::limits_for_large_models();
    limits.accepts_older_models = true;
    const auto loaded = model::load_nodesets(space, sources, limits);
    if (!loaded) {
        ModelReports reports;
        for (const Problem& problem : loaded.error()) {
            reports.add({ModelCode::FileInvalid, {}, problem.where, problem.text});
        }
        return Unexpected{std::move(reports)};
    }
    return detail::translate(state_->mapping, state_->space, space);
}

} // namespace busbar::controller
