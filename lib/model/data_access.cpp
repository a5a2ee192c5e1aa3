#include <busbar/model/data_access.hpp>

#include <utility>

#include "multi_state.hpp"

namespace busbar::model {

namespace {

/// The Properties of an item, with their values.
struct Properties {
    std::vector<std::pair<std::string, Variant>> values;

    void add(const char* name, Variant value) { values.emplace_back(name, std::move(value)); }
    template <typename T>
    void add_structure(const char* name, const T& value)
    {
        add(name, ExtensionObject::from(value));
    }
    template <typename T>
    void add_structures(const char* name, const Array<T>& values_of_it)
    {
        Array<ExtensionObject> objects;
        objects.reserve(values_of_it.size());
        for (const T& value : values_of_it) {
            objects.push_back(ExtensionObject::from(value));
        }
        add(name, std::move(objects));
    }
};

Properties properties_of(const DataItem& item)
{
    Properties properties;
    if (!item.definition.is_null()) {
        properties.add("Definition", item.definition);
    }
    if (item.value_precision) {
        properties.add("ValuePrecision", *item.value_precision);
    }
    return properties;
}

bool is_sound(const Range& range)
{
    return range.low <= range.high;
}

bool is_sound(const std::optional<Range>& range)
{
    return !range || is_sound(*range);
}

/// Sets the DataType if the caller has set none.
void set_default_type(NewVariable& variable, std::uint32_t data_type)
{
    if (variable.data_type.is_null() || variable.data_type.is(id::BaseDataType)) {
        variable.data_type = NodeId{0, data_type};
    }
}

/// Creates the Variable with its Properties, or nothing.
Result<NodeIndex> create(AddressSpace& space, const NewNode& node, const NodeId& type,
                         NewVariable variable, Properties properties)
{
    const NodeIndex type_node = space.find(type);
    if (type_node == no_node || !space.is_subtype_of(type_node, id::DataItemType)) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    InstanceOptions options;
    options.variable = std::move(variable);
    for (const auto& [name, value] : properties.values) {
        options.optional.push_back(name);
    }
    const auto created = instantiate(space, node, type_node, options);
    if (!created) {
        return created;
    }
    for (auto& [name, value] : properties.values) {
        const auto set = space.set_value(find_by_path(space, *created, name), std::move(value));
        if (!set) {
            static_cast<void>(space.remove(*created));
            return fail(set.error());
        }
    }
    return created;
}

/// The names and numbers of axes of the ArrayItemTypes.
struct ArrayLayout {
    std::uint32_t type;
    std::int32_t value_rank;
    std::size_t axis_count;
};

constexpr ArrayLayout array_layouts[] = {
    {id::YArrayItemType, 1, 1},
    {id::XYArrayItemType, 1, 1},
    {id::ImageItemType, 2, 2},
    {id::CubeItemType, 3, 3},
};

constexpr const char* axis_names[] = {"XAxisDefinition", "YAxisDefinition", "ZAxisDefinition"};

/// Adds the axes and sets the ValueRank; false if they do not fit the type.
bool add_axes(const ArrayItem& item, NewVariable& variable, Properties& properties)
{
    for (const AxisInformation& axis : item.axes) {
        if (!is_sound(axis.eu_range)) {
            return false;
        }
    }
    if (item.type.is(id::NDimensionArrayItemType)) {
        variable.value_rank = static_cast<std::int32_t>(item.axes.size());
        properties.add_structures("AxisDefinition", item.axes);
        return !item.axes.empty();
    }
    for (const ArrayLayout& layout : array_layouts) {
        if (item.type.is(layout.type) && item.axes.size() == layout.axis_count) {
            variable.value_rank = layout.value_rank;
            for (std::size_t i = 0; i < layout.axis_count; ++i) {
                properties.add_structure(axis_names[i], item.axes[i]);
            }
            return true;
        }
    }
    return false;
}

} // namespace

Result<NodeIndex> add_analog_item(AddressSpace& space, const NewNode& node, const AnalogItem& item)
{
    const NodeIndex type = space.find(item.type);
    if (!space.is_subtype_of(type, id::BaseAnalogType)) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    const bool has_range = item.eu_range || !space.is_subtype_of(type, id::AnalogItemType);
    const bool needs_units = space.is_subtype_of(type, id::AnalogUnitType) ||
                             space.is_subtype_of(type, id::AnalogUnitRangeType);
    const bool is_whole = has_range && (item.engineering_units || !needs_units);
    if (!is_whole || !is_sound(item.eu_range) || !is_sound(item.instrument_range)) {
        return fail(status::Bad_NodeAttributesInvalid);
    }
    Properties properties = properties_of(item);
    if (item.eu_range) {
        properties.add_structure("EURange", *item.eu_range);
    }
    if (item.engineering_units) {
        properties.add_structure("EngineeringUnits", *item.engineering_units);
    }
    if (item.instrument_range) {
        properties.add_structure("InstrumentRange", *item.instrument_range);
    }
    return create(space, node, item.type, item.variable, std::move(properties));
}

Result<NodeIndex> add_two_state(AddressSpace& space, const NewNode& node, const TwoStateItem& item)
{
    Properties properties = properties_of(item);
    properties.add("FalseState", item.false_state);
    properties.add("TrueState", item.true_state);
    NewVariable variable = item.variable;
    set_default_type(variable, id::Boolean);
    return create(space, node, NodeId{0, id::TwoStateDiscreteType}, std::move(variable),
                  std::move(properties));
}

Result<NodeIndex> add_multi_state(AddressSpace& space, const NewNode& node,
                                  const MultiStateItem& item)
{
    Properties properties = properties_of(item);
    properties.add("EnumStrings", item.enum_strings);
    NewVariable variable = item.variable;
    set_default_type(variable, id::UInt32);
    return create(space, node, NodeId{0, id::MultiStateDiscreteType}, std::move(variable),
                  std::move(properties));
}

Result<NodeIndex> add_multi_state_value(AddressSpace& space, const NewNode& node,
                                        const MultiStateValueItem& item)
{
    Properties properties = properties_of(item);
    properties.add_structures("EnumValues", item.enum_values);
    properties.add("ValueAsText", detail::text_of(item.variable.value, item.enum_values));
    NewVariable variable = item.variable;
    set_default_type(variable, id::Int32);
    return create(space, node, NodeId{0, id::MultiStateValueDiscreteType}, std::move(variable),
                  std::move(properties));
}

Result<NodeIndex> add_array_item(AddressSpace& space, const NewNode& node, const ArrayItem& item)
{
    Properties properties = properties_of(item);
    NewVariable variable = item.variable;
    if (!is_sound(item.eu_range) || !is_sound(item.instrument_range) ||
        !add_axes(item, variable, properties)) {
        return fail(status::Bad_NodeAttributesInvalid);
    }
    if (item.type.is(id::XYArrayItemType)) {
        variable.data_type = NodeId{0, id::XVType};
    }
    properties.add_structure("EURange", item.eu_range);
    properties.add_structure("EngineeringUnits", item.engineering_units);
    properties.add("Title", item.title);
    properties.add("AxisScaleType", item.axis_scale_type);
    if (item.instrument_range) {
        properties.add_structure("InstrumentRange", *item.instrument_range);
    }
    return create(space, node, item.type, std::move(variable), std::move(properties));
}

} // namespace busbar::model
