#include <busbar/controller/mapping_check.hpp>

#include <algorithm>

#include <busbar/binary/codec.hpp>
#include <busbar/controller/model_set.hpp>
#include <busbar/core/text.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "extension_attributes.hpp"
#include "node_properties.hpp"
#include "table_fields.hpp"
#include "value_check.hpp"

namespace busbar::controller {

ModelCode detail::code_of(NodePlace place)
{
    switch (place) {
    case NodePlace::StandardNode:
        return ModelCode::StandardNode;
    case NodePlace::BelowServer:
        return ModelCode::BelowServer;
    case NodePlace::BelowAliases:
        return ModelCode::BelowAliases;
    case NodePlace::RequiredNamespace:
        return ModelCode::RequiredNamespace;
    case NodePlace::ArgumentsProperty:
        return ModelCode::ArgumentsProperty;
    case NodePlace::WrongNodeClass:
        return ModelCode::WrongNodeClass;
    case NodePlace::Mappable:
    case NodePlace::NotBelowObjects:
        break;
    }
    return ModelCode::NotBelowObjects;
}

namespace {

using model::NodeIndex;

/// One check, with the result that its steps add to.
class Run {
public:
    Run(const model::SpaceReader& space, const Mapping& mapping, const MappingCheckOptions& options)
        : space_{space}, mapping_{mapping}, options_{options}, places_{space, options.required},
          values_{space, types_.of(space), options.limits, result_.reports}
    {
    }

    [[nodiscard]] MappingCheck take()
    {
        check_variables();
        check_methods();
        count_variables();
        check_types();
        result_.counters.file_size = options_.file_size;
        check_counters();
        return std::move(result_);
    }

private:
    void check_variables();
    void check_methods();
    void check_arguments(const NodeId& id, const std::vector<MappedPart>& mapped_arguments,
                         const std::vector<Argument>& arguments, const char* place);
    void check_additions(const NodeId& id, const DataMapping& mapping, NodeIndex node);
    void check_method_labels(const NodeId& id, const MethodMapping& method);
    [[nodiscard]] NodeIndex find(const NodeId& id, NodeClass node_class);
    void check_labels(const NodeId& id, const MappedPart& part, const std::string& path);
    void check_label(const NodeId& id, const std::string& label, const std::string& path);
    void count_variables();
    void check_types();
    void check_counters();
    [[nodiscard]] ValueDeclaration declaration_of(NodeIndex node) const;

    void report(ModelCode code, const NodeId& id, const std::string& path, std::string_view found)
    {
        const std::string where = to_string(id) + (path.empty() ? path : ": " + path);
        result_.reports.add({code, id, printable(where, 512), printable(found)});
    }
    template <typename Value>
    void exceeds(ModelCode code, Value value, Value limit)
    {
        if (value > limit) {
            result_.reports.add(
                {code, {}, {}, std::to_string(value) + ", at most " + std::to_string(limit)});
        }
    }

    const model::SpaceReader& space_;
    const Mapping& mapping_;
    const MappingCheckOptions& options_;
    NodePlaces places_;
    model::DataTypes types_;
    MappingCheck result_;
    detail::ValueCheck values_;
};

/// Sorts by NodeId, so that two checks report alike.
template <typename Map>
std::vector<const typename Map::value_type*> in_order(const Map& map)
{
    std::vector<const typename Map::value_type*> entries;
    entries.reserve(map.size());
    for (const auto& each : map) {
        entries.push_back(&each);
    }
    std::sort(entries.begin(), entries.end(),
              [](const auto* a, const auto* b) { return a->first < b->first; });
    return entries;
}

NodeIndex Run::find(const NodeId& id, NodeClass node_class)
{
    const NodeIndex node = space_.find(id);
    if (node == model::no_node) {
        report(ModelCode::NodeMissing, id, {}, {});
        return model::no_node;
    }
    const NodePlace place = places_.of(node);
    if (place != NodePlace::Mappable) {
        report(detail::code_of(place), id, {}, {});
        return model::no_node;
    }
    if (space_.node_class(node) != node_class) {
        report(ModelCode::WrongNodeClass, id, {}, {});
        return model::no_node;
    }
    return node;
}

void Run::check_variables()
{
    for (const auto* each : in_order(mapping_.variables)) {
        check_labels(each->first, each->second.value, {});
        if (!each->second.quality.empty()) {
            check_label(each->first, each->second.quality, std::string{detail::quality_part});
        }
        const NodeIndex node = find(each->first, NodeClass::Variable);
        if (node != model::no_node) {
            values_.check(each->first, {}, declaration_of(node), each->second.value);
            check_additions(each->first, each->second, node);
        }
    }
}

/// Checks the quality and the scaling.
void Run::check_additions(const NodeId& id, const DataMapping& mapping, NodeIndex node)
{
    const bool is_scaled = mapping.scaling.is_set();
    if (count_labels(mapping.value) == 0) {
        if (is_scaled || !mapping.quality.empty()) {
            report(ModelCode::QualityAlone, id, {}, {});
        }
        return;
    }
    const std::string scaling{detail::scaling_part};
    if (is_scaled && !detail::scaling_of(space_, node, mapping.scaling)) {
        report(ModelCode::ScalingInvalid, id, scaling,
               "found " + to_text(mapping.scaling) +
                   " and no EURange, expected the range of the Variable, too: " +
                   to_text(mapping.scaling) + "=0..100");
    }
    if (is_scaled && !values_.is_numeric(declaration_of(node), mapping.value)) {
        report(ModelCode::ScalingInvalid, id, scaling,
               "found the DataType " +
                   space_.browse_name(space_.variable(node).data_type).name.str() +
                   ", expected a number or an array of numbers");
    }
}

void Run::check_methods()
{
    for (const auto* each : in_order(mapping_.methods)) {
        const MethodMapping& method = each->second;
        check_method_labels(each->first, method);
        const NodeIndex node = find(each->first, NodeClass::Method);
        if (node == model::no_node) {
            continue;
        }
        const auto outputs = detail::arguments_of(space_, node, "OutputArguments");
        const bool has_outputs = !outputs.empty() || !method.outputs.empty();
        if ((has_outputs && method.done.empty()) ||
            (!method.done.empty() && method.handle.empty())) {
            report(ModelCode::MethodHasOutputs, each->first, {}, {});
        }
        check_arguments(each->first, method.arguments,
                        detail::arguments_of(space_, node, "InputArguments"), "Input[");
        check_arguments(each->first, method.outputs, outputs, "Output[");
    }
}

void Run::check_method_labels(const NodeId& id, const MethodMapping& method)
{
    for (const auto& [label, part] :
         {std::pair{&method.handle, detail::handle_part}, {&method.done, detail::done_part}}) {
        if (!label->empty()) {
            check_label(id, *label, std::string{part});
        }
    }
    for (const MappedPart& argument : method.arguments) {
        check_labels(id, argument, "Input[" + std::to_string(argument.number) + ']');
    }
    for (const MappedPart& output : method.outputs) {
        check_labels(id, output, "Output[" + std::to_string(output.number) + ']');
    }
}

void Run::check_arguments(const NodeId& id, const std::vector<MappedPart>& mapped_arguments,
                          const std::vector<Argument>& arguments, const char* place)
{
    std::vector<bool> is_mapped(arguments.size());
    for (const MappedPart& mapped : mapped_arguments) {
        const std::string path = place + std::to_string(mapped.number) + ']';
        if (mapped.number >= arguments.size()) {
            report(ModelCode::ArgumentUnknown, id, path, {});
            continue;
        }
        if (is_mapped[mapped.number]) {
            report(ModelCode::PartRepeated, id, path, {});
        }
        is_mapped[mapped.number] = true;
        const Argument& argument = arguments[mapped.number];
        values_.check(
            id, path,
            {argument.data_type, argument.value_rank, argument.array_dimensions.span(), true},
            mapped);
    }
}

void Run::check_labels(const NodeId& id, const MappedPart& part, const std::string& path)
{
    if (!part.label.empty()) {
        check_label(id, part.label, path);
    }
    for (const MappedPart& inner : part.parts) {
        check_labels(id, inner, part_path(path, inner));
    }
}

void Run::check_label(const NodeId& id, const std::string& label, const std::string& path)
{
    const std::size_t length = detail::character_count(label);
    ++result_.counters.labels;
    result_.counters.label_length += length;
    if (length > options_.limits.max_label_length) {
        report(ModelCode::LabelTooLong, id, path,
               std::to_string(length) + " characters, at most " +
                   std::to_string(options_.limits.max_label_length));
        return;
    }
    if (options_.check_label) {
        if (const auto problem = options_.check_label(label)) {
            report(ModelCode::LabelInvalid, id, path, label + ": " + text(*problem));
        }
    }
}

ValueDeclaration Run::declaration_of(NodeIndex node) const
{
    const model::VariableAttributes attributes = space_.variable(node);
    return {space_.data_type_id(node), attributes.value_rank, attributes.array_dimensions, false};
}

void Run::count_variables()
{
    std::uint32_t levels = 0;
    NodeIndex deepest = model::no_node;
    space_.for_each([&](NodeIndex node) {
        if (places_.level(node) > levels) {
            levels = places_.level(node);
            deepest = node;
        }
        if (!places_.is_counted(node)) {
            return;
        }
        ++result_.counters.variables;
        const auto mapped = mapping_.variables.find(space_.node_id(node));
        result_.counters.variable_words +=
            values_.words(declaration_of(node),
                          mapped == mapping_.variables.end() ? nullptr : &mapped->second.value);
    });
    if (levels > options_.limits.max_node_levels) {
        report(ModelCode::TooManyNodeLevels, space_.node_id(deepest), {},
               std::to_string(levels) + ", at most " +
                   std::to_string(options_.limits.max_node_levels));
    }
}

void Run::check_types()
{
    if (options_.limits.supports_all_types) {
        return;
    }
    const detail::UnsupportedTypes unsupported{space_};
    space_.for_each([&](NodeIndex node) {
        if (const NodeIndex type = unsupported.of(node); type != model::no_node) {
            report(ModelCode::TypeUnsupported, space_.node_id(node), {},
                   space_.browse_name(type).name.view());
        }
    });
}

void Run::check_counters()
{
    const ModelLimits& limits = options_.limits;
    const ModelCounters& counters = result_.counters;
    exceeds(ModelCode::TooManyLabels, counters.labels, limits.max_labels);
    exceeds(ModelCode::LabelsTooLong, counters.label_length, limits.max_total_label_length);
    exceeds(ModelCode::TooManyVariables, counters.variables, limits.max_variables);
    exceeds(ModelCode::VariablesTooLarge, counters.variable_words, limits.max_variable_words);
    exceeds(ModelCode::FilesTooLarge, counters.file_size, limits.max_file_size);
}

} // namespace

std::vector<std::string> required_uris(const ModelSet& models)
{
    std::vector<std::string> uris;
    for (const ModelNamespace& each : models.namespaces()) {
        for (const RequiredModelStatus& required : each.required) {
            uris.push_back(required.uri);
        }
    }
    return uris;
}

MappingCheck check_mapping(const model::SpaceReader& space, const Mapping& mapping,
                           const MappingCheckOptions& options)
{
    return Run{space, mapping, options}.take();
}

MappingCheck check_mapping(const ModelSet& models,
                           std::function<std::optional<Problem>(std::string_view)> check_label)
{
    const MappingCheckOptions options{models.limits(), required_uris(models), models.file_size(),
                                      std::move(check_label)};
    return check_mapping(models.space(), models.mapping(), options);
}

} // namespace busbar::controller
